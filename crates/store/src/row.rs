//! The traits of a kind of row that a store can hold: its tables, and how it is written and read.

use rusqlite::{Connection, Transaction};

/// A row that a [`Storage`](super::Storage) can keep: a [`Trial`](super::Trial) of a study or a
/// [`RobotRow`](super::RobotRow) of a search.
pub trait Row: Clone + Send {
    /// The index of the row in the order of its run.
    fn index(&self) -> usize;
}

/// A kind of row with its tables in the database.
pub trait Table: Row {
    /// Name of the main table, which has one entry for each row.
    const NAME: &'static str;
    /// The SQL that creates the tables.
    const TABLES: &'static str;

    /// Inserts the row and returns its checksum.
    fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64>;

    /// The rows with an id of at least `from` and below `to`, sorted by id.
    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>>;

    /// The checksums (stored, computed now) of the entries in additional tables.
    fn more_checksums(connection: &Connection) -> rusqlite::Result<Vec<(i64, i64)>> {
        let _ = connection;
        Ok(Vec::new())
    }
}

/// A row that was read, with its stored checksum and the checksum computed from its present content.
#[derive(Debug)]
pub struct Checked<R> {
    pub row: R,
    pub stored: i64,
    pub computed: i64,
}
