//! How much a store holds, noted outside of it.
//!
//! What a killed run stored last is in SQLite's log. A log that is cut, missing or of another run is no error to SQLite: the
//! rows in it were just never written. So the store's tally is noted in a file beside it for as long as there is a log: before a
//! write, the tally before and after it; after it, the new one alone. The file goes with the log, when the store is closed.

use std::fs::{self, File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::checksum::Tally;
use super::connection::with_suffix;
use super::description::{COMPLETE, ENDING};
use realgap_core::error::{Advice, Error, Result};

/// What follows the store's name in that of the file.
pub(super) const COUNT: &str = "-count";
/// Where what does not belong to a store is put.
pub(super) const SET_ASIDE: &str = "-set-aside";
/// Where SQLite says that changes may be in a log.
const VERSIONS: u64 = 18;
const LOGGED: [u8; 2] = [2, 2];

/// The note of a store that is open for writing.
#[derive(Debug)]
pub(super) struct Count {
    file: File,
    path: PathBuf,
}

impl Count {
    /// Of the store at `store`, which holds what `tally` says.
    pub fn open(store: &Path, tally: Tally) -> Result<Self> {
        let path = with_suffix(store, COUNT);
        let mut options = OpenOptions::new();
        let file = options.create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(|e| Error::io("write the file", &path, &e))?;
        let mut count = Self { file, path };
        count.note([tally; 2])?;
        Ok(count)
    }

    /// The store holds the first, or already the second.
    pub fn note(&mut self, tallies: [Tally; 2]) -> Result<()> {
        let text = tallies.map(|t| format!("{:016x} {:016x}\n", t.rows, t.checksum));
        // One write of always the same length: it is there or not.
        self.file
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.file.write_all(text.concat().as_bytes()))
            .map_err(|e| Error::io("write the file", &self.path, &e))
    }

    /// The store is closed and needs no note any more. Best effort: one that stays says what is true.
    pub fn remove(&self) {
        let _stays = fs::remove_file(&self.path);
    }
}

/// What is noted beside a store: `None` where nothing is, no tally where it cannot be read.
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

/// The tally in a store; nothing where it has none.
fn stored(connection: &Connection) -> Tally {
    let tally = connection.query_row("SELECT rows, checksum FROM tally", [], |row| {
        Ok(Tally {
            rows: row.get(0)?,
            checksum: row.get(1)?,
        })
    });
    tally.unwrap_or_default()
}

/// In what a store differs from what was stored last. Without a connection there is no store.
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
        Some(_) => "other entries than were stored".to_owned(),
        None => format!(
            "no whole {} of an unfinished run",
            name(&with_suffix(store, COUNT))
        ),
    }))
}

/// An error about such a difference.
pub(super) fn other_than_stored(store: &Path, found: String) -> Error {
    Error::conflict("the store does not hold what was stored last")
        .at_file(store)
        .found(found)
        .hint("a part of it was cut, lost or replaced: put the folder's own results.sqlite* back, or let what is lost be made again")
        .advise(Advice::Resume)
}

/// Whether a store says that its run came to its end.
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

/// Whether changes of a store may be in a log beside it.
fn is_logged(store: &Path) -> Result<bool> {
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

/// Whether a log lies beside a store that was closed, which has none.
pub(super) fn has_foreign_log(store: &Path) -> Result<bool> {
    // A writer says in the store that there is a log before there is one, and after there was one.
    Ok(has_log(store) && !is_logged(store)? && has_log(store))
}

/// Whether anything is in a log beside a store.
pub(super) fn has_log(store: &Path) -> bool {
    fs::metadata(with_suffix(store, "-wal")).is_ok_and(|log| log.len() > 0)
}

/// An error about such a log.
pub(super) fn foreign_log(store: &Path) -> Error {
    Error::conflict("this log is not of the store beside it, which was closed without one")
        .at_file(with_suffix(store, "-wal"))
        .hint("move it away")
        .advise(Advice::Resume)
}

/// Puts the log of a store where nobody reads it.
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
