//! Opens the SQLite file of a store, and translates SQLite's errors.

use std::fs::OpenOptions;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension as _};

use super::file_system::FileSystem;
use super::journal::{Journal, journal_of};
use realgap_core::error::{Advice, Error, Result};

/// How long a writer on a network file system waits for readers, who lock the whole file there.
const LONGEST_READING: Duration = Duration::from_secs(600);

/// Opens the file for writing.
///
/// On a disk of this computer it has a write-ahead log and `synchronous = NORMAL`: a killed process loses at most the
/// present transaction, a power cut at most the last few transactions; neither corrupts the file. A network file system does not share the
/// memory that such a log needs, so that the file there has a rollback journal and waits for the disk in every transaction.
pub(super) fn connect(path: &Path, file_system: &FileSystem) -> Result<Connection> {
    let fail = |e: rusqlite::Error| sql(path, "open the results", &e);
    let connection = Connection::open(path).map_err(fail)?;
    let (journal, synchronous) = match file_system {
        FileSystem::Own => ("WAL", "NORMAL"),
        _ => ("DELETE", "FULL"),
    };
    if *file_system != FileSystem::Own {
        connection.busy_timeout(LONGEST_READING).map_err(fail)?;
    }
    connection
        .query_row(&format!("PRAGMA journal_mode = {journal}"), [], |row| {
            row.get::<_, String>(0)
        })
        .optional()
        .map_err(fail)?;
    connection
        .pragma_update(None, "synchronous", synchronous)
        .map_err(fail)?;
    Ok(connection)
}

/// Takes back what a killed process has written halfway, as SQLite does before it reads a file that it may write. What a living process
/// is writing is left alone, because it holds a lock.
pub(super) fn take_back(path: &Path) -> Result<()> {
    if matches!(journal_of(path)?, Journal::None) {
        return Ok(());
    }
    let fail = |e: rusqlite::Error| sql(path, "open the results", &e);
    let connection = Connection::open(path).map_err(fail)?;
    connection
        .pragma_query_value(None, "schema_version", |row| row.get::<_, i64>(0))
        .map_err(fail)?;
    Ok(())
}

/// Merges the write-ahead log into the main file and removes the log, so that the file can be read from read-only media. Returns false
/// if another process is reading: then the log stays and is merged later.
pub(super) fn merge_log(connection: &Connection) -> bool {
    let mode = connection.query_row("PRAGMA journal_mode = DELETE", [], |row| {
        row.get::<_, String>(0)
    });
    mode.is_ok_and(|mode| mode == "delete")
}

/// Byte offsets of SQLite's change counter, and of the counter value for which its version field is valid.
/// Format: <https://www.sqlite.org/fileformat2.html#the_database_header>.
const COUNTERS: [u64; 2] = [24, 92];
const MAGIC: &[u8; 16] = b"SQLite format 3\0";

/// Sets the change counter of a closed file to a number that follows from its content, so that equal results are equal bytes however
/// often the file was opened. Errors are ignored.
pub(super) fn set_change_counter(path: &Path, number: u32) {
    let _refused = try_set_change_counter(path, number);
}

fn try_set_change_counter(path: &Path, number: u32) -> std::io::Result<()> {
    if with_suffix(path, "-wal").exists() || with_suffix(path, "-journal").exists() {
        return Ok(());
    }
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut magic = [0; 16];
    file.read_exact(&mut magic)?;
    if magic == *MAGIC {
        // Between the two writes SQLite uses the length of the file instead of the length in the header; both are equal.
        for at in COUNTERS {
            file.seek(SeekFrom::Start(at))?;
            file.write_all(&number.to_be_bytes())?;
        }
        file.sync_all()?;
    }
    Ok(())
}

/// Opens the file for reading, also while another process writes, and from read-only media.
pub(super) fn connect_to_read(path: &Path) -> Result<Connection> {
    let open = |path: &Path, flags| -> rusqlite::Result<Connection> {
        let connection = Connection::open_with_flags(path, flags)?;
        // An untrusted file must not run SQL functions from its schema.
        connection.pragma_update(None, "trusted_schema", false)?;
        connection.pragma_query_value(None, "schema_version", |row| row.get::<_, i64>(0))?;
        Ok(connection)
    };
    let read_only = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let refused = match open(path, read_only) {
        Ok(connection) => return Ok(connection),
        Err(error) => error,
    };
    let cannot_lock = matches!(
        refused.sqlite_error_code(),
        Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly | ErrorCode::PermissionDenied)
    );
    if !cannot_lock {
        return Err(sql(path, "open the results", &refused));
    }
    let log = with_suffix(path, "-wal");
    if std::fs::metadata(&log).is_ok_and(|log| log.len() > 0) {
        return Err(Error::conflict(
            "the run was interrupted, and its last results cannot be read in a read-only folder",
        )
        .at_file(&log)
        .hint("copy the whole folder to a writable place, and read it there"));
    }
    // What was written halfway must be taken back before anything is read.
    if !matches!(journal_of(path)?, Journal::None) {
        return Err(Error::conflict(
            "the run was interrupted in the middle of a write, which cannot be taken back here",
        )
        .at_file(with_suffix(path, "-journal"))
        .hint("resume the run, or copy the whole folder to a writable place and read it there"));
    }
    // No process can write to read-only media, so no lock is needed.
    let Some(immutable) = immutable_uri(path) else {
        return Err(sql(path, "open the results", &refused));
    };
    open(&immutable, read_only | OpenFlags::SQLITE_OPEN_URI)
        .map_err(|e| sql(path, "open the results", &e))
}

/// The URI `file:/path?immutable=1`, with every special byte of the path escaped.
fn immutable_uri(path: &Path) -> Option<PathBuf> {
    let whole = std::path::absolute(path).ok()?;
    let mut uri = "file:".to_owned();
    for byte in whole.to_str()?.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' => {
                uri.push(char::from(byte));
            }
            _ => uri += &format!("%{byte:02X}"),
        }
    }
    Some(PathBuf::from(uri + "?immutable=1"))
}

/// The path of a file beside the store, with a suffix after the store's file name.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// The hint about results that were changed after they were written.
pub(super) const DAMAGED_HINT: &str =
    "no value in this file can be trusted any more: restore it from a backup";

/// Translates an error of SQLite that occurred while `doing` something with the results at `path`.
pub(super) fn sql(path: &Path, doing: &str, error: &rusqlite::Error) -> Error {
    let plain = Error::conflict(format!("cannot {doing}: {error}")).at_file(path);
    match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => plain
            .hint("free some disk space; the results stored so far are safe")
            .advise(Advice::Resume),
        Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => plain
            .hint("check the permissions of the folder")
            .advise(Advice::OtherFolder),
        Some(ErrorCode::SystemIoFailure) => plain
            .hint("the disk may be full or failing; free some space")
            .advise(Advice::Resume),
        // The error without a code is a value of another type than its column, which SQLite itself would not have stored.
        Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) | None => {
            plain.hint(DAMAGED_HINT).advise(Advice::OtherFolder)
        }
        _ => plain,
    }
}
