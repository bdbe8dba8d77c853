//! Confidence intervals by drawing recordings again.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// An estimate with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate from all recordings.
    pub value: f64,
    /// 2.5 % of the resampled estimates lie below.
    pub low: f64,
    /// 2.5 % of the resampled estimates lie above.
    pub high: f64,
}

impl Interval {
    /// Whether the data allow `value`.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// The interval of the quantity times `factor`, more than 0.
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
/// `estimate` gets how often each recording is drawn; `None` (nothing can be estimated) is left out. `None` where
/// all recordings together give nothing; an unbounded interval for a single recording.
pub(super) fn intervals<const N: usize>(
    recordings: usize,
    seed: u64,
    estimate: impl Fn(&[f64]) -> Option<[f64; N]>,
) -> Option<[Interval; N]> {
    let values = estimate(&vec![1.0; recordings])?;
    if recordings < 2 {
        // One recording says nothing about how much another would differ.
        return Some(values.map(|value| Interval {
            value,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        }));
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut draws: Vec<[f64; N]> = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        let mut weights = vec![0.0; recordings];
        for _ in 0..recordings {
            weights[rng.random_range(0..recordings)] += 1.0;
        }
        draws.extend(estimate(&weights));
    }
    Some(std::array::from_fn(|index| {
        let mut sorted: Vec<f64> = draws.iter().map(|draw| draw[index]).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            sorted
                .get((share * sorted.len() as f64) as usize)
                .copied()
                .unwrap_or(values[index])
        };
        Interval {
            value: values[index],
            low: at(0.025),
            high: at(0.975),
        }
    }))
}
