//! Which of several workers does which rows.

use crate::error::{Error, Result};

/// Most workers that one run is shared among.
pub const MOST_SHARES: usize = 100_000;

/// The rows of a run that one worker of several does: those whose index leaves its number when divided by their count, so
/// that the rows of every batch are spread evenly, whoever has done some of them already.
///
/// ```
/// use realgap::store::Share;
///
/// let share = Share::new(1, 3)?;
/// assert_eq!((0..9).filter(|index| share.has(*index)).collect::<Vec<_>>(), [1, 4, 7]);
/// assert!(Share::new(3, 3).is_err());
/// # Ok::<(), realgap::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    number: usize,
    of: usize,
}

impl Share {
    /// Share `number` of so many, counted from 0.
    ///
    /// # Errors
    /// A number that there is not.
    pub fn new(number: usize, of: usize) -> Result<Self> {
        if !(1..=MOST_SHARES).contains(&of) {
            return Err(Error::usage("so many shards cannot be")
                .field("shards")
                .found(of)
                .allowed(format!("1 to {MOST_SHARES}")));
        }
        if number >= of {
            return Err(Error::usage("there is no such shard")
                .field("shard")
                .found(number)
                .allowed(format!("0 to {}", of - 1)));
        }
        Ok(Self { number, of })
    }

    /// Its number, from 0.
    pub fn number(self) -> usize {
        self.number
    }

    /// How many there are.
    pub fn of(self) -> usize {
        self.of
    }

    /// Whether the row with this index is its.
    pub fn has(self, index: usize) -> bool {
        index % self.of == self.number
    }
}
