//! The bootstrap: resampling with replacement (Efron & Tibshirani 1993, chapters 6 and 13).

use rand::RngExt;

use super::describe::quantile;
use crate::random::Once;

/// One resample: how often each item was drawn, divided by the number of draws.
#[derive(Debug, Clone, PartialEq)]
pub struct Resample {
    weights: Vec<f64>,
    draws: usize,
}

impl Resample {
    /// The weight of each item; they sum to 1.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// How often each item was drawn; they sum to the number of draws.
    pub fn counts(&self) -> Vec<f64> {
        let draws = self.draws as f64;
        self.weights.iter().map(|w| (w * draws).round()).collect()
    }

    /// The mean over the drawn items of `values`, which hold one value per item.
    pub fn mean(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.weights).map(|(v, w)| v * w).sum()
    }
}

/// `count` resamples of `items` items; the same seed gives the same resamples.
pub fn resamples(items: usize, count: usize, seed: u64) -> Vec<Resample> {
    draw(items, items, count, seed)
}

/// As [`resamples`], but with one draw less per resample. The variance of a resample's mean is then the unbiased estimate of the variance of
/// the mean, which the usual bootstrap underestimates by a factor of 1 − 1/n (Efron & Tibshirani 1993, section 6.2); this matters for few
/// items. Fewer than two items give no resamples.
pub fn smaller_resamples(items: usize, count: usize, seed: u64) -> Vec<Resample> {
    match items {
        0 | 1 => Vec::new(),
        _ => draw(items, items - 1, count, seed),
    }
}

fn draw(items: usize, draws: usize, count: usize, seed: u64) -> Vec<Resample> {
    let mut rng = Once::Resampling.generator(seed);
    (0..count)
        .map(|_| {
            let mut weights = vec![0.0; items];
            for _ in 0..draws {
                weights[rng.random_range(0..items)] += 1.0 / draws as f64;
            }
            Resample { weights, draws }
        })
        .collect()
}

/// Percentile interval of resampled values: a share of `tail` of the values lies below the interval, and the same
/// share above it. `None` for no values.
///
/// ```
/// use realgap_core::statistics::{percentile_interval, resamples};
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

    /// Variance of the mean of n values: s² / n, with the sample's s².
    #[test]
    fn smaller_resamples_vary_as_the_mean_of_few_values_does() {
        let values = [1.0, 2.0, 4.0];
        let expected = crate::statistics::standard_deviation(&values).powi(2) / 3.0;
        let means: Vec<f64> = smaller_resamples(3, 20_000, 5)
            .iter()
            .map(|resample| resample.mean(&values))
            .collect();
        let found = crate::statistics::standard_deviation(&means).powi(2);
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
        assert!(smaller_resamples(1, 10, 5).is_empty());
    }
}
