//! What a file that should be a store holds.

use rusqlite::Connection;
use std::path::Path;

use super::connection::sql;
use crate::error::{Advice, Error, Result};

/// Layout of the tables; raised when they change.
pub(super) const LAYOUT: i64 = 3;

/// What a file that should be a store holds.
pub(super) enum Content {
    /// Nothing: no file, or one that was killed before its tables were made.
    Nothing,
    /// Tables of this layout.
    Tables,
}

/// What a file holds, or why it is no store of this version.
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
        0 => Err(Error::conflict("this is no store of results")
            .at_file(path)
            .advise(Advice::OtherFolder)),
        older if older < LAYOUT => Err(other_layout(path, older)
            .hint("an earlier version wrote these results, and still reads them")
            .advise(Advice::OtherFolder)),
        newer => Err(other_layout(path, newer)
            .hint("a later version wrote these results: use that one")
            .advise(Advice::OtherFolder)),
    }
}

fn other_layout(path: &Path, found: i64) -> Error {
    Error::conflict("another version of this program wrote these results")
        .at_file(path)
        .found(format!("layout {found}"))
        .allowed(format!("layout {LAYOUT}"))
}
