//! The stored row of one simulated run of an ensemble.

use rusqlite::{Connection, Transaction, params};

use super::checksum::{Checksum, from_bytes, to_bytes};
use super::row::{Checked, Row, Table};

/// A run as numbers and words; the crate that wrote the row knows what they mean.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRow {
    /// The number of the run.
    pub index: usize,
    /// All numbers of the run.
    pub numbers: Vec<f64>,
    /// All other values of the run, as JSON.
    pub words: String,
}

impl RunRow {
    /// The approximate number of bytes that the row takes in a store.
    pub fn stored_bytes(&self) -> usize {
        24 + 8 * self.numbers.len() + self.words.len()
    }

    fn checksum(&self) -> i64 {
        Checksum::of(Self::NAME)
            .whole(self.index as i64)
            .bytes(&to_bytes(&self.numbers))
            .text(&self.words)
            .finish()
    }
}

impl Row for RunRow {
    fn index(&self) -> usize {
        self.index
    }
}

impl Table for RunRow {
    const NAME: &'static str = "run";
    const TABLES: &'static str = "CREATE TABLE run (
        id INTEGER PRIMARY KEY, numbers BLOB NOT NULL, words TEXT NOT NULL, checksum INTEGER NOT NULL) STRICT;";

    fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
        let checksum = self.checksum();
        transaction
            .prepare_cached("INSERT INTO run VALUES (?1, ?2, ?3, ?4)")?
            .execute(params![
                self.index as i64,
                to_bytes(&self.numbers),
                self.words,
                checksum
            ])?;
        Ok(checksum)
    }

    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>> {
        let mut statement = connection.prepare_cached(
            "SELECT id, numbers, words, checksum FROM run WHERE id >= ?1 AND id < ?2 ORDER BY id",
        )?;
        let rows = statement.query_map([from, to], |row| {
            let run = Self {
                index: row.get::<_, i64>(0)? as usize,
                numbers: from_bytes(row.get_ref(1)?.as_blob()?),
                words: row.get(2)?,
            };
            Ok(Checked {
                stored: row.get(3)?,
                computed: run.checksum(),
                row: run,
            })
        })?;
        rows.collect()
    }
}
