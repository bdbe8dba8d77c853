//! A number with its bootstrap interval.

use serde::Serialize;

use crate::statistics::{Resample, percentile_interval};

/// Bootstrap resamples behind every interval.
pub const RESAMPLES: usize = 2000;
/// Level of the intervals.
pub const INTERVAL_LEVEL: f64 = 0.95;

/// A number with its 95 % bootstrap interval over recordings (percentiles; Efron & Tibshirani 1993, chapter 13).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Lower end; `None` where there are too few recordings to resample.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Estimate {
    /// `value` with the interval of its resampled values; resamples that say nothing are left out.
    pub(super) fn new(
        value: f64,
        resamples: &[Resample],
        of: impl Fn(&Resample) -> Option<f64>,
    ) -> Self {
        let values: Vec<f64> = resamples.iter().filter_map(of).collect();
        let several = resamples.first().is_some_and(|r| r.weights().len() > 1);
        let tail = 0.5 - 0.5 * INTERVAL_LEVEL;
        let interval = percentile_interval(&values, tail).filter(|_| several);
        Self {
            value,
            low: interval.map(|(low, _)| low),
            high: interval.map(|(_, high)| high),
        }
    }
}
