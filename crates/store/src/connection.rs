//! Opening the SQLite file, and what its refusals mean.

use std::fs::OpenOptions;
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension as _};

use realgap_core::error::{Advice, Error, Result};

/// Opens for writing. WAL with `synchronous = NORMAL`: a killed process loses at most the
/// transaction under way, a power cut at most the last few; neither corrupts the file.
pub(super) fn connect(path: &Path) -> Result<Connection> {
    let fail = |e: rusqlite::Error| sql(path, "open the results", &e);
    let connection = Connection::open(path).map_err(fail)?;
    connection
        .query_row("PRAGMA journal_mode = WAL", [], |row| {
            row.get::<_, String>(0)
        })
        .optional()
        .map_err(fail)?;
    connection
        .pragma_update(None, "synchronous", "NORMAL")
        .map_err(fail)?;
    Ok(connection)
}

/// Merges the write-ahead log into the file and leaves the file alone in its folder, so that it can be read from media that
/// cannot be written; whether that was possible: with a reader at work the log stays, and is merged later.
pub(super) fn settle(connection: &Connection) -> bool {
    let mode = connection.query_row("PRAGMA journal_mode = DELETE", [], |row| {
        row.get::<_, String>(0)
    });
    mode.is_ok_and(|mode| mode == "delete")
}

/// Where SQLite counts the changes of a file, and where it says which count its other fields are of.
/// Format: <https://www.sqlite.org/fileformat2.html#the_database_header>.
const COUNTERS: [u64; 2] = [24, 92];
const MAGIC: &[u8; 16] = b"SQLite format 3\0";

/// Gives a settled file, which nobody has open, a count of changes that follows from what is in it: how often it was opened on
/// the way is no result. Best effort.
pub(super) fn stamp(path: &Path, number: u32) {
    let _refused = try_stamp(path, number);
}

fn try_stamp(path: &Path, number: u32) -> std::io::Result<()> {
    if with_suffix(path, "-wal").exists() || with_suffix(path, "-journal").exists() {
        return Ok(());
    }
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut magic = [0; 16];
    file.read_exact(&mut magic)?;
    if magic == *MAGIC {
        // Between the two SQLite takes the length of the file for what the header would say: the same.
        for at in COUNTERS {
            file.seek(SeekFrom::Start(at))?;
            file.write_all(&number.to_be_bytes())?;
        }
        file.sync_all()?;
    }
    Ok(())
}

/// Opens for reading: also beside a writer, and from media that cannot be written.
pub(super) fn connect_to_read(path: &Path) -> Result<Connection> {
    let open = |path: &Path, flags| -> rusqlite::Result<Connection> {
        let connection = Connection::open_with_flags(path, flags)?;
        // A foreign file must not run anything of its own.
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
            "the run was interrupted, and its last results cannot be read where nothing can be written",
        )
        .at_file(&log)
        .hint("copy the whole folder to where it can be written, and read it there"));
    }
    // Nobody writes there, so nothing needs to be locked.
    let Some(immutable) = immutable_uri(path) else {
        return Err(sql(path, "open the results", &refused));
    };
    open(&immutable, read_only | OpenFlags::SQLITE_OPEN_URI)
        .map_err(|e| sql(path, "open the results", &e))
}

/// `file:/path?immutable=1`, with every byte of the path that means something in a URI escaped.
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

/// The files that SQLite puts beside its own.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}

/// What to do about results that are not what was written.
pub(super) const DAMAGED_HINT: &str =
    "nothing in this file can be trusted any more: take it from a backup";

/// An error of SQLite while `doing` something with the results at `path`.
pub(super) fn sql(path: &Path, doing: &str, error: &rusqlite::Error) -> Error {
    let plain = Error::conflict(format!("cannot {doing}: {error}")).at_file(path);
    match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => plain
            .hint("free some disk space; what was stored so far is safe")
            .advise(Advice::Resume),
        Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => plain
            .hint("check the permissions of the folder")
            .advise(Advice::OtherFolder),
        Some(ErrorCode::SystemIoFailure) => plain
            .hint("the disk may be full or failing; free some space")
            .advise(Advice::Resume),
        // Or a value of another type than the column's: SQLite itself would never have stored it.
        Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) | None => {
            plain.hint(DAMAGED_HINT).advise(Advice::OtherFolder)
        }
        _ => plain,
    }
}
