//! Reads bags of ROS 2: SQLite databases with messages of many topics.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use rusqlite::{Connection, MAIN_DB};

use super::connection::with_suffix;
use super::journal::{Journal, journal_of};
use super::log::{Rest, damage_of, rest_of};
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;

/// The first bytes of an SQLite database.
const SIGNATURE: &[u8] = b"SQLite format 3\0";
/// Byte range of the header fields that say whether later changes are in a write-ahead log.
const VERSIONS: std::ops::Range<usize> = 18..20;
/// Byte range of the number by which a program may mark its databases, and the mark of a bag whose last change is left out.
const MARK: std::ops::Range<usize> = 68..72;
const UNFINISHED: &[u8; 4] = b"rgUF";

pub(super) fn refused(error: &rusqlite::Error) -> Error {
    Error::invalid("the bag cannot be read as a database")
        .found(error)
        .hint("repair a truncated bag with `ros2 bag reindex`; decompress a compressed bag with `zstd -d`")
}

/// One message of a bag.
#[derive(Debug, Clone, Copy)]
pub struct BagMessage<'a> {
    pub topic: &'a str,
    /// Name of the message's type.
    pub kind: &'a str,
    /// Encoding of the message, e.g. `cdr`.
    pub encoding: &'a str,
    /// The time at which the message was recorded, nanoseconds.
    pub log_time_ns: i64,
    pub data: &'a [u8],
}

/// Suffixes of the files that a killed or still active recorder has beside its bag: the write-ahead log with changes that are not in the bag
/// yet, and the rollback journal with the old content of unfinished changes.
const UNCLOSED: [&str; 2] = ["-wal", "-journal"];

/// The bytes of the bag at `path` as if its recorder had closed it; at most `limit` + 1 bytes of the file are read. In a temporary copy,
/// SQLite applies the committed changes and rolls back the others. The files of the bag itself are not changed.
///
/// # Errors
/// A file that cannot be read; a bag that another process is writing; a log or journal that is damaged or cut off; no disk space for
/// the copy.
pub fn read_closed_bag(path: &Path, limit: u64) -> Result<Vec<u8>> {
    if unclosed(path).is_empty() {
        return read_limited(path, limit, "bag");
    }
    let size = std::fs::metadata(path).map_or(0, |file| file.len());
    if size > limit {
        return read_limited(path, limit, "bag");
    }
    closed(path, |copy, is_unfinished| {
        let mut bytes = std::fs::read(copy).map_err(|e| Error::io("read the bag", copy, &e))?;
        if is_unfinished {
            mark_unfinished(&mut bytes);
        }
        Ok(bytes)
    })
}

/// Marks the bytes of a bag whose last change is left out; [`read_bag`] tells.
pub(super) fn mark_unfinished(bytes: &mut [u8]) {
    if let Some(mark) = bytes.get_mut(MARK) {
        mark.copy_from_slice(UNFINISHED);
    }
}

/// The files beside a bag that its recorder has not closed.
pub(super) fn unclosed(path: &Path) -> Vec<PathBuf> {
    let beside = UNCLOSED.map(|suffix| with_suffix(path, suffix));
    let is_there = |file: &PathBuf| std::fs::metadata(file).is_ok_and(|file| file.len() > 0);
    beside.into_iter().filter(is_there).collect()
}

/// Calls `read` with a closed copy of a bag that was not closed, and whether a change of it was left out.
///
/// # Errors
/// The errors of [`read_closed_bag`] and of `read`.
pub(super) fn closed<T>(path: &Path, read: impl FnOnce(&Path, bool) -> Result<T>) -> Result<T> {
    let state = || -> Vec<Option<(u64, Option<SystemTime>)>> {
        let files = [path.to_path_buf()].into_iter().chain(unclosed(path));
        let seen = files.map(|file| std::fs::metadata(file).ok());
        seen.map(|file| file.map(|file| (file.len(), file.modified().ok())))
            .collect()
    };
    let before = state();
    let damaged = |suffix: &str, what: &str, found: String, lost: &str| {
        Error::invalid(what)
            .at_file(with_suffix(path, suffix))
            .found(found)
            .allowed("exactly the bytes that its recorder wrote")
            .hint(format!(
                "{lost}: copy it from the robot once more. Where it cannot be had, remove it from a copy of the bag, and `ros2 bag reindex` repairs what is there"
            ))
    };
    let log = "the last messages of the bag are in this file";
    if let Some(found) = damage_of(path)? {
        return Err(damaged("-wal", "the log of the bag is damaged", found, log));
    }
    let rest = rest_of(path)?;
    if rest == Rest::Cut {
        let found = "an end in the middle of a page".to_owned();
        return Err(damaged("-wal", "the log of the bag is cut off", found, log));
    }
    let journal = journal_of(path)?;
    if let Journal::Damaged(found) = journal {
        return Err(damaged(
            "-journal",
            "the journal of the bag is damaged",
            found,
            "what the recorder's last change has overwritten is in this file",
        ));
    }
    let is_unfinished = rest == Rest::Unfinished || journal == Journal::Whole;
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("realgap-bag-{}-{number}", std::process::id()));
    let done = close_copy(path, &folder).and_then(|copy| {
        // What another process has written meanwhile is in the copy, or it is not.
        match state() == before {
            true => read(&copy, is_unfinished),
            false => Err(Error::conflict("another process is writing into this bag")
                .at_file(path)
                .hint("read the bag after its recorder has ended")),
        }
    });
    // An error is ignored, because a temporary folder that remains does no harm.
    let _left = std::fs::remove_dir_all(&folder);
    done
}

/// Copies a bag with its log or journal into `folder`, and closes the copy there.
fn close_copy(path: &Path, folder: &Path) -> Result<PathBuf> {
    let copy = folder.join("bag.db3");
    let fail = |e: std::io::Error| Error::io("copy the bag to close it", folder, &e);
    std::fs::create_dir(folder).map_err(fail)?;
    std::fs::copy(path, &copy).map_err(fail)?;
    for file in unclosed(path) {
        let suffix = UNCLOSED.into_iter().find(|s| file == with_suffix(path, s));
        std::fs::copy(file, with_suffix(&copy, suffix.unwrap_or_default())).map_err(fail)?;
    }
    let sql = |error: rusqlite::Error| refused(&error).at_file(path);
    let bag = Connection::open(&copy).map_err(sql)?;
    bag.pragma_update(None, "trusted_schema", false)
        .map_err(sql)?;
    // Any read rolls unfinished changes back; the change of the journal mode merges the log.
    let mode = |row: &rusqlite::Row<'_>| row.get::<_, String>(0);
    bag.query_row("PRAGMA journal_mode = DELETE", [], mode)
        .map_err(sql)?;
    let whole: String = bag
        .query_row("PRAGMA quick_check(1)", [], mode)
        .map_err(sql)?;
    if whole != "ok" {
        return Err(
            Error::invalid("the bag and its log or journal do not belong together")
                .at_file(path)
                .found(whole)
                .hint(
                    "copy NAME.db3, NAME.db3-wal and NAME.db3-journal from the robot at the same time",
                ),
        );
    }
    Ok(copy)
}

/// Checks that a database of this size has as many bytes as its header says, because SQLite reads the missing rest of a truncated last
/// page as zeros. Format: <https://www.sqlite.org/fileformat2.html#the_database_header>.
pub(super) fn must_be_whole(header: &[u8], size: u64) -> Result<()> {
    if !header.starts_with(SIGNATURE) {
        return Err(Error::invalid("this file is no bag of ROS 2")
            .found("other first bytes")
            .allowed("a SQLite database"));
    }
    let word = |at: usize| {
        let bytes = header.get(at..at + 4).and_then(|four| four.try_into().ok());
        bytes.map_or(0, u32::from_be_bytes)
    };
    let page = match header.get(16..18) {
        Some([0, 1]) => 65_536,
        Some([high, low]) => 256 * u64::from(*high) + u64::from(*low),
        _ => 0,
    };
    // The number of pages in the header is valid only if the last change has written it.
    let pages = if word(24) == word(92) {
        u64::from(word(28))
    } else {
        0
    };
    if page < 512 || !size.is_multiple_of(page) || size < pages * page {
        return Err(Error::invalid("the bag is truncated")
            .found(format!("{size} bytes"))
            .allowed(format!("{} pages of {page} bytes", pages.max(1)))
            .hint("copy it from the robot once more; `ros2 bag reindex` repairs the part that is there"));
    }
    Ok(())
}

/// Refuses a database without the tables of a bag. Only tables are accepted: a view of an untrusted file could compute endlessly.
pub(super) fn must_be_bag(bag: &Connection) -> Result<()> {
    let tables = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')";
    let count = bag.query_row(tables, [], |row| row.get::<_, i64>(0));
    if count.map_err(|error| refused(&error))? != 2 {
        return Err(Error::invalid("this database is no bag of ROS 2")
            .allowed("the tables `topics` and `messages`"));
    }
    Ok(())
}

/// Calls `each` with every message of the bag with these bytes, sorted by time. True if its recorder has left a change unfinished, whose
/// messages are not in the bag.
///
/// # Errors
/// Bytes that are not a bag, or a damaged one; errors of `each`.
pub fn read_bag(
    mut bytes: Vec<u8>,
    each: &mut dyn FnMut(&BagMessage<'_>) -> Result<()>,
) -> Result<bool> {
    must_be_whole(&bytes, bytes.len() as u64)?;
    let is_unfinished = bytes.get(MARK) == Some(UNFINISHED);
    // The header is set to "no write-ahead log", because a database in memory has no file beside it.
    if let Some(versions) = bytes.get_mut(VERSIONS) {
        versions.fill(1);
    }
    let sql = |error: rusqlite::Error| refused(&error);
    let mut bag = Connection::open_in_memory().map_err(sql)?;
    bag.deserialize_read_exact(MAIN_DB, bytes.as_slice(), bytes.len(), true)
        .map_err(sql)?;
    drop(bytes);
    must_be_bag(&bag)?;
    let messages = "SELECT t.name, t.type, t.serialization_format, m.timestamp, m.data \
                    FROM messages AS m JOIN topics AS t ON t.id = m.topic_id ORDER BY m.timestamp, m.id";
    let mut messages = bag.prepare(messages).map_err(sql)?;
    let mut rows = messages.query([]).map_err(sql)?;
    while let Some(row) = rows.next().map_err(sql)? {
        let text = |column: usize| Some(row.get_ref(column).ok()?.as_str().ok()?.to_owned());
        let data = row.get_ref(4).ok();
        let data = data.and_then(|data| data.as_blob().ok());
        let parts = (text(0), text(1), text(2), row.get::<_, i64>(3).ok(), data);
        let (Some(topic), Some(kind), Some(encoding), Some(log_ns), Some(data)) = parts else {
            return Err(Error::invalid("the bag is damaged")
                .found("a message without topic, type, encoding, time or content"));
        };
        each(&BagMessage {
            topic: &topic,
            kind: &kind,
            encoding: &encoding,
            log_time_ns: log_ns,
            data,
        })?;
    }
    Ok(is_unfinished)
}
