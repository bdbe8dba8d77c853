//! Notes the number of rows of a store in a file beside it, so that lost rows are noticed.
//!
//! The last rows of a killed run are in SQLite's write-ahead log. A log that is cut, missing or of another run is no error for SQLite:
//! it reads the store as if the rows in the log had never been written. So the store's tally (the number of rows and their checksum) is
//! noted in a file beside the store for as long as there is a log: before a write, the tallies before and after it; after the write, only
//! the new tally. The file is removed together with the log, when the store is closed.

use std::fs::{self, File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::checksum::Tally;
use super::connection::with_suffix;
use super::description::{COMPLETE, ENDING};
use realgap_core::error::{Advice, Error, Result};

/// Suffix of the file with the note, after the store's file name.
pub(super) const COUNT: &str = "-count";
/// Suffix of the file name under which a log that does not belong to a store is kept.
pub(super) const SET_ASIDE: &str = "-set-aside";
/// Byte offset of the header fields in which SQLite says whether changes may be in a write-ahead log.
const VERSIONS: u64 = 18;
/// The values of these fields if changes may be in a log.
const LOGGED: [u8; 2] = [2, 2];

/// The note with the tallies of a store that is open for writing.
#[derive(Debug)]
pub(super) struct Count {
    file: File,
    path: PathBuf,
}

impl Count {
    /// Opens the note of the store at `store`, whose rows have this tally.
    pub fn open(store: &Path, tally: Tally) -> Result<Self> {
        let path = with_suffix(store, COUNT);
        let mut options = OpenOptions::new();
        let file = options.create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(|e| Error::io("write the file", &path, &e))?;
        let mut count = Self { file, path };
        count.note([tally; 2])?;
        Ok(count)
    }

    /// Notes that the store has the first of these tallies, or already the second.
    pub fn note(&mut self, tallies: [Tally; 2]) -> Result<()> {
        let text = tallies.map(|t| format!("{:016x} {:016x}\n", t.rows, t.checksum));
        // The note is a single write of constant length, so it is written completely or not at all.
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(text.concat().as_bytes()))
            .map_err(|e| Error::io("write the file", &self.path, &e))
    }

    /// Removes the note of a store that is closed. An error is ignored, because a note that stays is still correct.
    pub fn remove(&self) {
        let _stays = fs::remove_file(&self.path);
    }
}

/// The tallies noted beside a store: `None` if there is no note, an empty list if the note cannot be parsed.
fn noted(store: &Path) -> Result<Option<Vec<Tally>>> {
    let path = with_suffix(store, COUNT);
    let text = match fs::read(&path) {
        Ok(text) => String::from_utf8_lossy(&text).into_owned(),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(Error::io("read the file", &path, &e)),
    };
    let number = |word: &str| u64::from_str_radix(word, 16).ok().map(|n| n as i64);
    let tally = |line: &str| {
        let (rows, checksum) = line.split_once(' ')?;
        let (rows, checksum) = (number(rows)?, number(checksum)?);
        Some(Tally { rows, checksum })
    };
    let tallies: Option<Vec<Tally>> = text.lines().map(tally).collect();
    Ok(Some(
        tallies.filter(|all| all.len() == 2).unwrap_or_default(),
    ))
}

/// The tally that a store holds; zero if it has none.
fn stored(connection: &Connection) -> Tally {
    let tally = connection.query_row("SELECT rows, checksum FROM tally", [], |row| {
        Ok(Tally {
            rows: row.get(0)?,
            checksum: row.get(1)?,
        })
    });
    tally.unwrap_or_default()
}

/// How a store differs from the tally that was noted last; `None` if it does not differ. `connection` is `None` if there is no store.
///
/// # Errors
/// Files that cannot be read.
pub(super) fn difference(store: &Path, connection: Option<&Connection>) -> Result<Option<String>> {
    let stored = connection.map_or(Tally::default(), stored);
    let last = match noted(store)? {
        Some(noted) if noted.contains(&stored) => return Ok(None),
        Some(noted) => noted.last().copied(),
        None if !is_logged(store)? || connection.is_some_and(is_complete) => return Ok(None),
        None => None,
    };
    Ok(Some(match last {
        Some(last) if last.rows != stored.rows => {
            format!("{} entries where {} were stored", stored.rows, last.rows)
        }
        Some(_) => "other entries than those that were stored".to_owned(),
        None => format!(
            "no complete {} of an unfinished run",
            name(&with_suffix(store, COUNT))
        ),
    }))
}

/// The error about a store that differs from the tally that was noted last.
pub(super) fn mismatch_error(store: &Path, found: String) -> Error {
    Error::conflict("the store does not hold the rows that were stored last")
        .at_file(store)
        .found(found)
        .hint("a part of it was cut, lost or replaced: put the folder's own results.sqlite* back, or let the lost rows be computed again")
        .advise(Advice::Resume)
}

/// True if a store says that its run is complete.
fn is_complete(connection: &Connection) -> bool {
    let ending = "SELECT value FROM description WHERE name = ?1";
    let ending = connection.query_row(ending, [ENDING], |row| row.get::<_, String>(0));
    ending.is_ok_and(|ending| ending == COMPLETE)
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// True if changes of a store may be in a write-ahead log beside it.
pub(super) fn is_logged(store: &Path) -> Result<bool> {
    let mut versions = [0; 2];
    let read = File::open(store).and_then(|mut file| {
        file.seek(SeekFrom::Start(VERSIONS))?;
        file.read(&mut versions)
    });
    match read {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io("read the results", store, &e))
        }
        _ => Ok(versions == LOGGED),
    }
}

/// True if a log is beside a store that was closed; a closed store has no log of its own.
pub(super) fn has_foreign_log(store: &Path) -> Result<bool> {
    // A writer marks the store as logged before it creates the log, and removes the mark only after it removed the log.
    Ok(has_log(store) && !is_logged(store)? && has_log(store))
}

/// True if there is a log beside a store that is not empty.
pub(super) fn has_log(store: &Path) -> bool {
    fs::metadata(with_suffix(store, "-wal")).is_ok_and(|log| log.len() > 0)
}

/// The error about a log that does not belong to the store.
pub(super) fn foreign_log(store: &Path) -> Error {
    Error::conflict(
        "this log does not belong to the store beside it, which was closed without a log",
    )
    .at_file(with_suffix(store, "-wal"))
    .hint("move the log away")
    .advise(Advice::Resume)
}

/// Renames the log of a store, so that SQLite does not read it.
pub(super) fn set_log_aside(store: &Path) -> Result<()> {
    let log = with_suffix(store, "-wal");
    let _none = fs::remove_file(with_suffix(store, "-shm"));
    match fs::rename(&log, with_suffix(store, SET_ASIDE)) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io("set a foreign log aside", &log, &e))
        }
        _ => Ok(()),
    }
}
