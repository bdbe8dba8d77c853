//! Reads and writes the named texts of a store, which describe its rows.

use rusqlite::{Connection, OptionalExtension as _, Transaction, params};

use super::checksum::{Checksum, Tally};

/// Name of the text with the number of rows that a run will have.
pub(super) const ASKED: &str = "asked";
/// Name of the text that says whether the run is complete, and its two values.
pub(super) const ENDING: &str = "ending";
pub(super) const COMPLETE: &str = "complete";
pub(super) const UNFINISHED: &str = "unfinished";

/// Stores a named text, and replaces an older text of this name.
pub(super) fn put_description(
    transaction: &Transaction<'_>,
    tally: &mut Tally,
    name: &str,
    value: &str,
) -> rusqlite::Result<()> {
    let old: Option<String> = transaction
        .query_row(
            "SELECT value FROM description WHERE name = ?1",
            [name],
            |row| row.get(0),
        )
        .optional()?;
    if let Some(old) = old {
        tally.remove(entry_checksum("description", name, &old));
    }
    transaction.execute(
        "INSERT OR REPLACE INTO description VALUES (?1, ?2)",
        params![name, value],
    )?;
    tally.add(entry_checksum("description", name, value));
    Ok(())
}

pub(super) fn entries(
    connection: &Connection,
    query: &str,
) -> rusqlite::Result<Vec<(String, String)>> {
    let mut statement = connection.prepare(query)?;
    let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    rows.collect()
}

pub(super) fn entry_checksum(table: &str, name: &str, value: &str) -> i64 {
    Checksum::of(table).text(name).text(value).finish()
}
