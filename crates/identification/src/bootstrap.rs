//! Confidence intervals of estimates by the percentile bootstrap over recordings.

use serde::Serialize;

use realgap_core::statistics::{percentile_interval, resamples};

/// Number of resamples of the bootstrap.
const RESAMPLES: usize = 1000;
/// Share of the resampled estimates on either side of an interval of 95 %.
const TAIL: f64 = 0.025;

/// An estimate with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Interval {
    /// The estimate from all recordings.
    pub value: f64,
    /// Lower end: 2.5 % of the resampled estimates lie below it.
    pub low: f64,
    /// Upper end: 2.5 % of the resampled estimates lie above it.
    pub high: f64,
}

impl Interval {
    /// Whether `value` is within the interval.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The interval of the quantity multiplied by `factor`, which is greater than 0.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            low: self.low * factor,
            high: self.high * factor,
        }
    }
}

/// Percentile bootstrap over recordings (Efron & Tibshirani 1993, chapter 13) of several quantities at once.
///
/// `estimate` receives how often each recording is drawn; resamples for which it returns `None` (nothing can be estimated) are
/// left out. The result is `None` if nothing can be estimated from all recordings together. The interval of a single recording
/// is unbounded.
pub(super) fn intervals<const N: usize>(
    recordings: usize,
    seed: u64,
    estimate: impl Fn(&[f64]) -> Option<[f64; N]>,
) -> Option<[Interval; N]> {
    let values = estimate(&vec![1.0; recordings])?;
    if recordings < 2 {
        // The spread between recordings is unknown if there is only one.
        return Some(values.map(|value| Interval {
            value,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        }));
    }
    let draws: Vec<[f64; N]> = draws_of(recordings, seed, estimate);
    Some(std::array::from_fn(|index| {
        let drawn: Vec<f64> = draws.iter().map(|draw| draw[index]).collect();
        let value = values[index];
        let (low, high) = percentile_interval(&drawn, TAIL).unwrap_or((value, value));
        Interval { value, low, high }
    }))
}

/// The weighted mean of a quantity over recordings; `None` if all weights are zero.
pub(super) fn weighted_mean(weights: &[f64], values: &[f64]) -> Option<[f64; 1]> {
    let total: f64 = weights.iter().sum();
    let sum: f64 = weights.iter().zip(values).map(|(w, v)| w * v).sum();
    (total > 0.0).then(|| [sum / total])
}

/// The estimates for all resamples of the recordings. Resamples for which `estimate` returns `None` are left out, and the result
/// is empty for a single recording.
pub(super) fn draws_of<T>(
    recordings: usize,
    seed: u64,
    estimate: impl Fn(&[f64]) -> Option<T>,
) -> Vec<T> {
    if recordings < 2 {
        return Vec::new();
    }
    resamples(recordings, RESAMPLES, seed)
        .iter()
        .filter_map(|resample| estimate(&resample.counts()))
        .collect()
}
