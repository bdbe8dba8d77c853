//! Where rows go as they come: a results folder, or memory.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::row::Row;
use realgap_core::error::Result;

/// Keeps rows of one kind by their index: [`Store`](super::Store) in a results folder, [`Memory`] for as long as it lives. What is
/// computed from the rows has the same bits either way.
pub trait Storage<R> {
    /// Indices of the rows that are there.
    ///
    /// # Errors
    /// A store that cannot be read.
    fn finished(&self) -> Result<BTreeSet<usize>>;

    /// Keeps rows, all of them or none.
    ///
    /// # Errors
    /// A full disk, or a row that is already there.
    fn insert(&mut self, rows: &[R]) -> Result<()>;

    /// The rows with an index in `range`, by index.
    ///
    /// # Errors
    /// A store that cannot be read.
    fn rows_within(&self, range: Range<usize>) -> Result<Vec<R>>;

    /// Hears how many rows a run wants in the end of the batch that begins, those before it included.
    fn begin(&mut self, rows: usize) {
        let _ = rows;
    }

    /// Whether a row that is missing is to be made for this storage: one of several workers takes its share alone.
    fn takes(&self, index: usize) -> bool {
        let _ = index;
        true
    }
}

/// Rows in memory.
///
/// ```
/// use realgap_store::{Memory, Storage, Trial};
///
/// let mut memory = Memory::default();
/// memory.insert(&[Trial { index: 3, values: vec![0.5], cases: Vec::new() }])?;
/// assert_eq!(memory.rows_within(0..9)?[0].values, [0.5]);
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Memory<R>(BTreeMap<usize, R>);

impl<R> Default for Memory<R> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<R: Row> Storage<R> for Memory<R> {
    fn finished(&self) -> Result<BTreeSet<usize>> {
        Ok(self.0.keys().copied().collect())
    }

    fn insert(&mut self, rows: &[R]) -> Result<()> {
        self.0
            .extend(rows.iter().map(|row| (row.index(), row.clone())));
        Ok(())
    }

    fn rows_within(&self, range: Range<usize>) -> Result<Vec<R>> {
        Ok(self.0.range(range).map(|(_, row)| row.clone()).collect())
    }
}
