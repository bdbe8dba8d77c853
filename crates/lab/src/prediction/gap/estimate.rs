//! An estimate with its interval over recordings.

use serde::{Deserialize, Serialize};

use realgap_core::statistics::{Degree, jackknife_interval};

/// Level of the intervals.
pub const INTERVAL_LEVEL: f64 = 0.95;

/// A number with its 95 % interval over recordings: Student's t with the jackknife of its logarithm ([`jackknife_interval`]).
/// docs/validation/gap.md has its coverage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Lower end; `None` where there are too few recordings, or distances of 0.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Estimate {
    /// `value` with the interval that follows from its values without each recording; `None` in `without` where such a value is
    /// unknown.
    pub(super) fn new(
        value: f64,
        without: impl Iterator<Item = Option<f64>>,
        degree: Degree,
    ) -> Self {
        let without: Option<Vec<f64>> = without.collect();
        let interval = without.and_then(|w| jackknife_interval(value, &w, INTERVAL_LEVEL, degree));
        Self {
            value,
            low: interval.map(|(low, _)| low),
            high: interval.map(|(_, high)| high),
        }
    }
}
