//! A cache of the mean strength and the shadowing between pairs of positions, which are constant during a simulation.

use std::collections::HashMap;
use std::sync::{PoisonError, RwLock};

/// Largest number of cached pairs of positions, where both directions count separately; they take at most 9 MB.
pub const MOST_PAIRS: usize = 1 << 16;

/// The bits of the two positions, so that only exactly equal pairs have the same key.
type Key = [[u64; 3]; 2];

fn key(from_m: [f64; 3], to_m: [f64; 3]) -> Key {
    [from_m, to_m].map(|place| place.map(f64::to_bits))
}

/// The cached values for a pair of positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    /// Mean strength, which depends on distance and walls, dBm.
    pub(super) mean_dbm: f64,
    /// Value of the shadowing field, in standard deviations; 0 if noise is off.
    pub(super) shadow: f64,
}

/// The two generations of the cache: when the recent one is full, it replaces the earlier one, which is discarded.
#[derive(Debug, Default)]
struct Generations {
    recent: HashMap<Key, Between>,
    earlier: HashMap<Key, Between>,
}

/// The cache of pairs. A cached value equals the value that would be computed, so the cache affects only the computing time.
#[derive(Debug, Default)]
pub(super) struct Pairs(RwLock<Generations>);

impl Pairs {
    pub(super) fn get(&self, from_m: [f64; 3], to_m: [f64; 3]) -> Option<Between> {
        let generations = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let key = key(from_m, to_m);
        generations
            .recent
            .get(&key)
            .or_else(|| generations.earlier.get(&key))
            .copied()
    }

    pub(super) fn keep(&self, from_m: [f64; 3], to_m: [f64; 3], between: Between) {
        let mut generations = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if generations.recent.len() >= MOST_PAIRS / 2 {
            generations.earlier = std::mem::take(&mut generations.recent);
        }
        generations.recent.insert(key(from_m, to_m), between);
    }

    pub(super) fn len(&self) -> usize {
        let generations = self.0.read().unwrap_or_else(PoisonError::into_inner);
        generations.recent.len() + generations.earlier.len()
    }
}
