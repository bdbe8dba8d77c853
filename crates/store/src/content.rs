//! Determines whether a file is a store of results, and of which version.

use rusqlite::Connection;
use std::path::Path;

use super::connection::{connect_to_read, sql};
use realgap_core::error::{Advice, Error, Result};

/// Version of the tables' layout; it is increased when the tables change.
pub(super) const LAYOUT: i64 = 3;

/// The content of a file that should be a store.
pub(super) enum Content {
    /// Nothing: there is no file, or its process was killed before it created the tables.
    Nothing,
    /// Tables of this layout.
    Tables,
}

/// Determines the content of a file.
///
/// # Errors
/// A file that is not a store, or a store of another version.
pub(super) fn content(connection: &Connection, path: &Path) -> Result<Content> {
    let fail = |e: rusqlite::Error| sql(path, "read the results", &e);
    let layout: i64 = connection
        .pragma_query_value(None, "user_version", |row| row.get(0))
        .map_err(fail)?;
    if layout == LAYOUT {
        return Ok(Content::Tables);
    }
    let tables: i64 = connection
        .query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))
        .map_err(fail)?;
    match layout {
        0 if tables == 0 => Ok(Content::Nothing),
        0 => Err(Error::conflict("this file is not a store of results")
            .at_file(path)
            .advise(Advice::OtherFolder)),
        older if older < LAYOUT => Err(other_layout(path, older)
            .hint("an earlier version wrote these results: read them with that version")
            .advise(Advice::OtherFolder)),
        newer => Err(other_layout(path, newer)
            .hint("a later version wrote these results: use that version")
            .advise(Advice::OtherFolder)),
    }
}

/// True if a file cannot have been written by this program, so this program must not remove it: a database of another program, or a file
/// that is no database in a folder without earlier results.
pub(super) fn is_foreign(path: &Path, is_known_folder: bool) -> bool {
    if !path.exists() {
        return false;
    }
    match connect_to_read(path) {
        Err(_) => !is_known_folder,
        Ok(connection) => {
            let number = |query| connection.query_row(query, [], |row| row.get::<_, i64>(0));
            let layout = number("PRAGMA user_version");
            let tables = number("SELECT count(*) FROM sqlite_schema");
            match (layout, tables) {
                (Ok(0), Ok(tables)) => tables > 0,
                (Ok(_), Ok(_)) => false,
                _ => !is_known_folder,
            }
        }
    }
}

fn other_layout(path: &Path, found: i64) -> Error {
    Error::conflict("another version of this program wrote these results")
        .at_file(path)
        .found(format!("layout {found}"))
        .allowed(format!("layout {LAYOUT}"))
}
