//! An observed share of trials with its Wilson confidence interval; and the normal quantile.

use serde::{Deserialize, Serialize};
use statrs::function::erf::erfc_inv;

/// A share of trials with its Wilson score interval (Wilson 1927), which is also valid near 0 and 1 and for few trials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proportion {
    /// Number of trials in which the event happened.
    pub count: usize,
    /// Number of trials.
    pub trials: usize,
    /// `count / trials`; 0 without trials.
    pub share: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Proportion {
    /// The share `count / trials` with its two-sided interval at `level`, e.g. 0.95.
    ///
    /// ```
    /// let walked = realgap_core::statistics::Proportion::new(3, 20, 0.95);
    /// assert!((walked.low - 0.052).abs() < 5e-4 && (walked.high - 0.360).abs() < 5e-4);
    /// ```
    pub fn new(count: usize, trials: usize, level: f64) -> Self {
        if trials == 0 {
            return Self {
                count,
                trials,
                share: 0.0,
                low: 0.0,
                high: 1.0,
            };
        }
        let share = count as f64 / trials as f64;
        let (low, high) = Self::interval_of(share, trials, level);
        Self {
            count,
            trials,
            share,
            low,
            high,
        }
    }

    /// The share of trials that are true, with its interval as in [`Self::new`].
    pub fn of(trials: impl IntoIterator<Item = bool>, level: f64) -> Self {
        let (mut count, mut all) = (0, 0);
        for is in trials {
            count += usize::from(is);
            all += 1;
        }
        Self::new(count, all, level)
    }

    /// The same interval for a share that need not be a count divided by the trials. For a mean of shares, one per trial, the interval is
    /// wider than necessary.
    pub fn interval_of(share: f64, trials: usize, level: f64) -> (f64, f64) {
        let n = trials as f64;
        let z = normal_quantile(0.5 + 0.5 * level);
        let z2 = z * z;
        let centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half = z / (1.0 + z2 / n) * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
        let low = if share == 0.0 { 0.0 } else { centre - half };
        let high = if share == 1.0 { 1.0 } else { centre + half };
        (low.max(0.0), high.min(1.0))
    }
}

/// Quantile of the standard normal distribution.
pub fn normal_quantile(level: f64) -> f64 {
    -std::f64::consts::SQRT_2 * erfc_inv(2.0 * level)
}
