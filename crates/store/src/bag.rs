//! Reads bags of ROS 2: SQLite databases with messages of many topics.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use rusqlite::{Connection, MAIN_DB};

use super::connection::with_suffix;
use super::log::damage_of;
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;

/// The first bytes of an SQLite database.
const SIGNATURE: &[u8] = b"SQLite format 3\0";
/// Byte range of the header fields that say whether later changes are in a write-ahead log.
const VERSIONS: std::ops::Range<usize> = 18..20;

fn refused(error: &rusqlite::Error) -> Error {
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
/// A file that cannot be read; a bag that another process is writing; a damaged log; no disk space for the copy.
pub fn read_closed_bag(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let unclosed = || -> Vec<PathBuf> {
        let beside = UNCLOSED.map(|suffix| with_suffix(path, suffix));
        let is_there = |file: &PathBuf| std::fs::metadata(file).is_ok_and(|file| file.len() > 0);
        beside.into_iter().filter(is_there).collect()
    };
    let state = || -> Vec<Option<(u64, Option<SystemTime>)>> {
        let files = [path.to_path_buf()].into_iter().chain(unclosed());
        let seen = files.map(|file| std::fs::metadata(file).ok());
        seen.map(|file| file.map(|file| (file.len(), file.modified().ok())))
            .collect()
    };
    let before = state();
    let bytes = read_limited(path, limit, "bag")?;
    if bytes.len() as u64 > limit || unclosed().is_empty() {
        return Ok(bytes);
    }
    if let Some(found) = damage_of(path)? {
        return Err(Error::invalid("the log of the bag is damaged")
            .at_file(with_suffix(path, "-wal"))
            .found(found)
            .allowed("exactly the bytes that its recorder wrote")
            .hint(
                "the last messages of the bag are in this file: copy it from the robot once more",
            ));
    }
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("realgap-bag-{}-{number}", std::process::id()));
    let closed = close_copy(path, &bytes, &unclosed(), &folder);
    // An error is ignored, because a temporary folder that remains does no harm.
    let _left = std::fs::remove_dir_all(&folder);
    if state() != before {
        return Err(Error::conflict("another process is writing into this bag")
            .at_file(path)
            .hint("read the bag after its recorder has ended"));
    }
    closed
}

/// Copies a bag and its log or journal into `folder`, closes the copy there, and returns its bytes.
fn close_copy(path: &Path, bytes: &[u8], beside: &[PathBuf], folder: &Path) -> Result<Vec<u8>> {
    let copy = folder.join("bag.db3");
    let fail = |e: std::io::Error| Error::io("copy the bag to close it", folder, &e);
    std::fs::create_dir(folder).map_err(fail)?;
    std::fs::write(&copy, bytes).map_err(fail)?;
    for file in beside {
        let suffix = UNCLOSED.into_iter().find(|s| *file == with_suffix(path, s));
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
    drop(bag);
    std::fs::read(&copy).map_err(fail)
}

/// Checks that a database has as many bytes as its header says, because SQLite reads the missing rest of a truncated last page as zeros.
/// Format: <https://www.sqlite.org/fileformat2.html#the_database_header>.
fn must_be_whole(bytes: &[u8]) -> Result<()> {
    let word = |at: usize| {
        let bytes = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        bytes.map_or(0, u32::from_be_bytes)
    };
    let page = match bytes.get(16..18) {
        Some([0, 1]) => 65_536,
        Some([high, low]) => 256 * usize::from(*high) + usize::from(*low),
        _ => 0,
    };
    // The number of pages in the header is valid only if the last change has written it.
    let pages = if word(24) == word(92) {
        word(28) as usize
    } else {
        0
    };
    if page < 512 || !bytes.len().is_multiple_of(page) || bytes.len() < pages * page {
        return Err(Error::invalid("the bag is truncated")
            .found(format!("{} bytes", bytes.len()))
            .allowed(format!("{} pages of {page} bytes", pages.max(1)))
            .hint("copy it from the robot once more; `ros2 bag reindex` repairs the part that is there"));
    }
    Ok(())
}

/// Calls `each` with every message of the bag with these bytes, sorted by time.
///
/// # Errors
/// Bytes that are not a bag, or a damaged one; errors of `each`.
pub fn read_bag(
    mut bytes: Vec<u8>,
    each: &mut dyn FnMut(&BagMessage<'_>) -> Result<()>,
) -> Result<()> {
    if !bytes.starts_with(SIGNATURE) {
        return Err(Error::invalid("this file is no bag of ROS 2")
            .found("other first bytes")
            .allowed("a SQLite database"));
    }
    must_be_whole(&bytes)?;
    // The header is set to "no write-ahead log", because a database in memory has no file beside it.
    if let Some(versions) = bytes.get_mut(VERSIONS) {
        versions.fill(1);
    }
    let sql = |error: rusqlite::Error| refused(&error);
    let mut bag = Connection::open_in_memory().map_err(sql)?;
    bag.deserialize_read_exact(MAIN_DB, bytes.as_slice(), bytes.len(), true)
        .map_err(sql)?;
    drop(bytes);
    // Only tables are accepted: a view of an untrusted file could compute endlessly.
    let tables = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')";
    let count: i64 = bag.query_row(tables, [], |row| row.get(0)).map_err(sql)?;
    if count != 2 {
        return Err(Error::invalid("this database is no bag of ROS 2")
            .allowed("the tables `topics` and `messages`"));
    }
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
    Ok(())
}
