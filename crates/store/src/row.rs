//! What a kind of row must know so that a store can keep it.

use rusqlite::{Connection, Transaction};

/// A row that a [`Storage`](super::Storage) can keep: a [`Trial`](super::Trial) of a study or a
/// [`RobotRow`](super::RobotRow) of a search.
pub trait Row: Clone + Send {
    /// Its index in the order of its run.
    fn index(&self) -> usize;
}

/// A kind of row and its tables.
pub trait Table: Row {
    /// Name of the table with one row each.
    const NAME: &'static str;
    /// What makes the tables.
    const TABLES: &'static str;

    /// Inserts the row and returns its checksum.
    fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64>;

    /// The rows with an id from `from` to just below `to`, by id.
    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>>;

    /// Checksums, as written and as they are now, of rows in tables beside these.
    fn more_checksums(connection: &Connection) -> rusqlite::Result<Vec<(i64, i64)>> {
        let _ = connection;
        Ok(Vec::new())
    }
}

/// A row as it was read, with the checksum that it was written with and the one that it has now.
#[derive(Debug)]
pub struct Checked<R> {
    pub row: R,
    pub stored: i64,
    pub computed: i64,
}
