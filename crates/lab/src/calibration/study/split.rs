//! Which recordings are fitted, and which are held out to check the fit.

use std::fmt;

use rand::seq::SliceRandom;

use realgap_core::random::Once;
use realgap_core::{Error, Result};

/// Which recordings are held out of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Split {
    /// Cross-validation with so many folds: every recording is held out once and checked with the best point of the others.
    Folds(usize),
    /// This share of the recordings is held out, more than 0 and less than 1.
    HoldOut(f64),
}

impl fmt::Display for Split {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folds(folds) => write!(f, "{folds} folds"),
            Self::HoldOut(share) => write!(f, "{share} held out"),
        }
    }
}

/// The recordings that are held out in fold number `fold` of so many, in shuffled order; the same for the same seed.
pub(in crate::calibration) fn fold(
    recordings: usize,
    seed: u64,
    folds: usize,
    fold: usize,
) -> Vec<usize> {
    let order = shuffled(recordings, seed).into_iter();
    order.skip(fold).step_by(folds).collect()
}

/// Shuffled order of the recordings; the same for the same seed.
fn shuffled(recordings: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..recordings).collect();
    order.shuffle(&mut Once::Split.generator(seed));
    order
}

impl Split {
    /// For each recording, whether it is held out of the fit of the whole study. Folds hold none out of that fit.
    ///
    /// # Errors
    /// More folds than recordings, a share out of range, or no recordings on one side.
    pub fn held_out(self, recordings: usize, seed: u64) -> Result<Vec<bool>> {
        let mut flags = vec![false; recordings];
        match self {
            Self::Folds(folds) => {
                if !(2..=recordings).contains(&folds) {
                    return Err(Error::usage("the recordings cannot be parted like this")
                        .field("folds")
                        .found(format!("{folds} folds of {recordings} recordings"))
                        .allowed("2 up to the number of recordings")
                        .hint(
                            "record more repeats; one recording cannot be held out from itself",
                        ));
                }
            }
            Self::HoldOut(share) => {
                let count = (share * recordings as f64).round();
                if !(share > 0.0 && share < 1.0) || count < 1.0 || count >= recordings as f64 {
                    return Err(Error::usage("the recordings cannot be parted like this")
                        .field("hold_out")
                        .found(format!("a share of {share} of {recordings} recordings"))
                        .allowed("a share between 0 and 1 that leaves at least one recording on either side"));
                }
                for index in shuffled(recordings, seed).into_iter().take(count as usize) {
                    flags[index] = true;
                }
            }
        }
        Ok(flags)
    }
}
