//! What must hold of the draws of every study, and of the ranks of many truths.

use crate::{INTERVAL_LEVEL, Marginal, PosteriorDraws};
use realgap_core::statistics::percentile_interval;

/// Asserts that intervals and draws of a parameter say the same: the only interval consists of quantiles of the draws, several ones
/// hold the draws but for their tails, and all values that are compatible contain the intervals.
pub fn agree(
    axis: usize,
    parts: &[(f64, f64)],
    draws: &PosteriorDraws,
    set: impl Iterator<Item = f64>,
) {
    let values: Vec<f64> = draws.rows().iter().map(|row| row[axis]).collect();
    if let [one] = parts {
        let tail = 0.5 * (1.0 - INTERVAL_LEVEL);
        assert_eq!(Some(*one), percentile_interval(&values, tail));
    }
    let is_in = |value: &&f64| parts.iter().any(|(l, h)| (*l..=*h).contains(*value));
    let share = values.iter().filter(is_in).count() as f64 / values.len() as f64;
    assert!(share >= INTERVAL_LEVEL - 0.06, "{share} in {parts:?}");
    let marginal = Marginal::new(axis, set, Some(draws));
    assert_eq!(marginal.intervals, parts);
    for (low, high) in parts {
        assert!(
            marginal.low <= *low && *high <= marginal.high,
            "{marginal:?}"
        );
    }
}

/// Simulation-based calibration (Talts et al. 2018): where draws have the posterior distribution, the rank of the truth among them
/// is uniform. The chi-squared statistic of the ranks in `RANK_BINS` bins.
pub fn rank_statistic(ranks: &[f64]) -> f64 {
    let mut counts = [0.0; RANK_BINS];
    for rank in ranks {
        counts[((rank * RANK_BINS as f64) as usize).min(RANK_BINS - 1)] += 1.0;
    }
    let expected = ranks.len() as f64 / RANK_BINS as f64;
    let squares = counts.map(|count: f64| (count - expected).powi(2) / expected);
    squares.iter().sum()
}

pub const RANK_BINS: usize = 5;
