//! Mean, spread and quantiles of one number over the repeats.

use serde::{Deserialize, Serialize};

use realgap_core::statistics::{mean, quantile, standard_deviation};

/// Levels of the quantiles of a [`Quantiles`].
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// How one number is spread over the repeats, in its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quantiles {
    /// Mean.
    pub mean: f64,
    /// Sample standard deviation; 0 for one value.
    pub standard_deviation: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// 25 % quantile.
    pub q25: f64,
    /// Median.
    pub q50: f64,
    /// 75 % quantile.
    pub q75: f64,
    /// 95 % quantile.
    pub q95: f64,
}

impl Quantiles {
    /// The spread of some values; `None` where there are none.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let [q05, q25, q50, q75, q95] = QUANTILES.map(|level| quantile(values, level));
        Some(Self {
            mean: mean(values),
            standard_deviation: standard_deviation(values),
            q05,
            q25,
            q50,
            q75,
            q95,
        })
    }
}
