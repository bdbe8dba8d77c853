//! What two places alone decide of a message, kept: neither walls nor shadows move while a service lasts.

use std::collections::HashMap;
use std::sync::{PoisonError, RwLock};

/// Pairs of places that are kept at most, each direction for itself: at most 9 MB.
pub const MOST_PAIRS: usize = 1 << 16;

/// From where to where, bit by bit: what is not exactly the same pair is another one.
type Key = [[u64; 3]; 2];

fn key(from_m: [f64; 3], to_m: [f64; 3]) -> Key {
    [from_m, to_m].map(|place| place.map(f64::to_bits))
}

/// What lies between two places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    /// Strength by distance and walls, dBm.
    pub(super) mean_dbm: f64,
    /// The field of shadows there, in standard deviations; 0 where there are none.
    pub(super) shadow: f64,
}

/// The pairs asked for last and those before them. When the former are as many as may be, the latter go.
#[derive(Debug, Default)]
struct Halves {
    recent: HashMap<Key, Between>,
    earlier: HashMap<Key, Between>,
}

/// Pairs that were asked for before. What is kept is what would be computed, so that nobody can tell but by the time it takes.
#[derive(Debug, Default)]
pub(super) struct Pairs(RwLock<Halves>);

impl Pairs {
    pub(super) fn get(&self, from_m: [f64; 3], to_m: [f64; 3]) -> Option<Between> {
        let halves = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let key = key(from_m, to_m);
        halves
            .recent
            .get(&key)
            .or_else(|| halves.earlier.get(&key))
            .copied()
    }

    pub(super) fn keep(&self, from_m: [f64; 3], to_m: [f64; 3], between: Between) {
        let mut halves = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if halves.recent.len() >= MOST_PAIRS / 2 {
            halves.earlier = std::mem::take(&mut halves.recent);
        }
        halves.recent.insert(key(from_m, to_m), between);
    }

    pub(super) fn len(&self) -> usize {
        let halves = self.0.read().unwrap_or_else(PoisonError::into_inner);
        halves.recent.len() + halves.earlier.len()
    }
}
