//! The interface for storing rows as they are computed, in a results folder or in memory.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::row::Row;
use realgap_core::error::Result;

/// Stores rows of one kind by their index: [`Store`](super::Store) in a results folder, [`Memory`] in memory. Values that are computed
/// from the stored rows have the same bits in both cases.
pub trait Storage<R> {
    /// Indices of the stored rows.
    ///
    /// # Errors
    /// A store that cannot be read.
    fn finished(&self) -> Result<BTreeSet<usize>>;

    /// Stores rows, either all of them or none.
    ///
    /// # Errors
    /// A full disk, or a row that is already stored.
    fn insert(&mut self, rows: &[R]) -> Result<()>;

    /// The rows with an index in `range`, sorted by index.
    ///
    /// # Errors
    /// A store that cannot be read.
    fn rows_within(&self, range: Range<usize>) -> Result<Vec<R>>;

    /// Notes, at the start of a batch, how many rows the run will have at the end of this batch, earlier rows included.
    fn begin(&mut self, rows: usize) {
        let _ = rows;
    }

    /// True if a missing row is to be computed for this storage; one of several workers computes only its share.
    fn takes(&self, index: usize) -> bool {
        let _ = index;
        true
    }
}

/// A storage of rows in memory.
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
