//! Resampling with replacement (Efron & Tibshirani 1993, chapters 6 and 13).

use rand::RngExt;

use super::describe::quantile;
use crate::random::Once;

/// One resample: how often each of n items was drawn, divided by n.
#[derive(Debug, Clone, PartialEq)]
pub struct Resample(Vec<f64>);

impl Resample {
    /// The weight of each item; they sum to 1.
    pub fn weights(&self) -> &[f64] {
        &self.0
    }

    /// How often each item was drawn; they sum to the number of items.
    pub fn counts(&self) -> Vec<f64> {
        let items = self.0.len() as f64;
        self.0.iter().map(|w| (w * items).round()).collect()
    }

    /// The mean of one value an item over the items drawn.
    pub fn mean(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.0).map(|(v, w)| v * w).sum()
    }
}

/// `count` resamples of `items` items; the same for the same seed.
pub fn resamples(items: usize, count: usize, seed: u64) -> Vec<Resample> {
    let mut rng = Once::Resampling.generator(seed);
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

/// Percentile interval of resampled values: a share of `tail` of them lies below it and as much
/// above. `None` for no values.
///
/// ```
/// use realgap::statistics::{percentile_interval, resamples};
///
/// let heights_m = [1.0, 1.2, 1.1, 1.4, 0.9];
/// let means: Vec<f64> = resamples(5, 2000, 1).iter().map(|r| r.mean(&heights_m)).collect();
/// let (low_m, high_m) = percentile_interval(&means, 0.025).expect("there are values");
/// assert!(0.9 < low_m && low_m < 1.12 && 1.12 < high_m && high_m < 1.4);
/// ```
pub fn percentile_interval(values: &[f64], tail: f64) -> Option<(f64, f64)> {
    let interval = (quantile(values, tail), quantile(values, 1.0 - tail));
    (!values.is_empty()).then_some(interval)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_and_sum_to_the_number_of_items() {
        for items in [1, 3, 7, 49, 1000] {
            for resample in resamples(items, 20, 3) {
                let counts = resample.counts();
                assert!(counts.iter().all(|count| count.fract() == 0.0));
                assert_eq!(counts.iter().sum::<f64>(), items as f64);
            }
        }
    }
}
