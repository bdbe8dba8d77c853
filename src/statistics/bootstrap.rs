//! Resampling with replacement (Efron & Tibshirani 1993, chapters 6 and 13).

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One resample: how often each of n items was drawn, divided by n.
#[derive(Debug, Clone, PartialEq)]
pub struct Resample(Vec<f64>);

impl Resample {
    /// The weight of each item; they sum to 1.
    pub fn weights(&self) -> &[f64] {
        &self.0
    }

    /// The mean of one value an item over the items drawn.
    pub fn mean(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.0).map(|(v, w)| v * w).sum()
    }
}

/// `count` resamples of `items` items; the same for the same seed.
pub fn resamples(items: usize, count: usize, seed: u64) -> Vec<Resample> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let mut weights = vec![0.0; items];
            for _ in 0..items {
                weights[rng.random_range(0..items)] += 1.0 / items as f64;
            }
            Resample(weights)
        })
        .collect()
}
