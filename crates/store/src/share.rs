//! Divides the rows of a run among several workers.

use realgap_core::error::{Error, Result};

/// The largest number of workers that one run is divided among.
pub const MAX_SHARES: usize = 100_000;

/// The rows of a run that one of several workers computes. In every block of as many rows as there are workers, each worker computes one
/// row, and every block starts with another worker. So neither a short batch nor a pattern that repeats along the rows (such as expensive
/// settings) is left to a few workers only.
///
/// ```
/// use realgap_store::Share;
///
/// let share = Share::new(1, 3)?;
/// assert_eq!((0..9).filter(|index| share.has(*index)).collect::<Vec<_>>(), [0, 5, 6]);
/// assert!(Share::new(3, 3).is_err());
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    number: usize,
    of: usize,
}

impl Share {
    /// Share `number` of `of` shares, counted from 0.
    ///
    /// # Errors
    /// A number of shares out of range, or a share number that does not exist.
    pub fn new(number: usize, of: usize) -> Result<Self> {
        if !(1..=MAX_SHARES).contains(&of) {
            return Err(Error::usage("the number of shards is out of range")
                .field("shards")
                .found(of)
                .allowed(format!("1 to {MAX_SHARES}")));
        }
        if number >= of {
            return Err(Error::usage("there is no such shard")
                .field("shard")
                .found(number)
                .allowed(format!("0 to {}", of - 1)));
        }
        Ok(Self { number, of })
    }

    /// The number of this share, from 0.
    pub fn number(self) -> usize {
        self.number
    }

    /// The number of all shares.
    pub fn of(self) -> usize {
        self.of
    }

    /// True if the row with this index belongs to this share.
    pub fn has(self, index: usize) -> bool {
        Self::owner(index, self.of) == self.number
    }

    /// The number of the share to which the row with this index belongs.
    pub fn owner(index: usize, of: usize) -> usize {
        let turned = mixed((index / of) as u64) % of as u64;
        (index % of + turned as usize) % of
    }
}

/// A hash of a number that is the same on every machine and in every version: splitmix64 (Steele, Lea and Flood 2014).
fn mixed(number: u64) -> u64 {
    let x = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_belongs_to_one_share_and_repeating_settings_are_spread_over_all_shares() {
        for of in [1, 2, 3, 8, 16, 32] {
            let shares: Vec<Share> = (0..of).map(|n| Share::new(n, of).unwrap()).collect();
            let mut settings = vec![std::collections::BTreeSet::new(); of];
            let mut rows = vec![0; of];
            for index in 0..16_384 {
                let owners: Vec<usize> = (0..of).filter(|n| shares[*n].has(index)).collect();
                assert_eq!(owners.len(), 1);
                settings[owners[0]].insert(index % 16);
                rows[owners[0]] += 1;
            }
            let (fewest, most) = (rows.iter().min().unwrap(), rows.iter().max().unwrap());
            assert!(most - fewest <= 1, "{rows:?}");
            assert!(
                settings.iter().all(|kinds| kinds.len() == 16),
                "{of}: {settings:?}"
            );
        }
    }
}
