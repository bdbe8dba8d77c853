//! Allowed ranges of numbers, with one check and one error message for values from files and from callers.

use crate::error::{Error, Result};

/// A range of allowed numbers; NaN is never allowed.
///
/// ```
/// use realgap_core::range::Range;
///
/// let duration = Range::within(0.001, 3600.0, "s");
/// assert!(duration.check(2.0, "duration_s").is_ok());
/// let error = duration.check(0.0, "duration_s").unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "duration_s: out of range\n  found:   0 s\n  allowed: 0.001 s to 3600 s"
/// );
/// let error = Range::above(0.0, 1.0, "").check(f64::NAN, "share").unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "share: not a number that can be used\n  found:   NaN\n  allowed: more than 0, at most 1"
/// );
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    low: f64,
    low_excluded: bool,
    high: f64,
    unit: &'static str,
}

impl Range {
    /// The numbers from `low` to `high`, both included; `unit` is empty for a number without a unit.
    pub const fn within(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low,
            low_excluded: false,
            high,
            unit,
        }
    }

    /// The numbers above `low` up to `high`, which is included.
    pub const fn above(low: f64, high: f64, unit: &'static str) -> Self {
        Self {
            low_excluded: true,
            ..Self::within(low, high, unit)
        }
    }

    /// True for a number that is allowed.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.low && value <= self.high && !(self.low_excluded && value == self.low)
    }

    /// Refuses a number that is not allowed; `at` names its field.
    ///
    /// # Errors
    /// What was found, and what is allowed.
    pub fn check(&self, value: f64, at: &str) -> Result<()> {
        self.refusal(value).map_or(Ok(()), |e| Err(e.field(at)))
    }

    /// The error of [`Range::check`] without a field name, for callers that add the field themselves; `None` for an allowed value.
    pub fn refusal(&self, value: f64) -> Option<Error> {
        let problem = if value.is_finite() {
            "out of range"
        } else {
            "not a number that can be used"
        };
        (!self.contains(value)).then(|| {
            Error::invalid(problem)
                .found(self.with_unit(value))
                .allowed(self)
        })
    }

    fn with_unit(&self, value: f64) -> String {
        let separator = if self.unit.is_empty() { "" } else { " " };
        format!("{}{separator}{}", number(value), self.unit)
    }
}

impl std::fmt::Display for Range {
    /// Writes the allowed numbers in words, e.g. `more than 0 kg, at most 100 kg`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (low, high) = (self.with_unit(self.low), self.with_unit(self.high));
        match (self.low_excluded, self.high == f64::INFINITY) {
            (true, true) => write!(f, "more than {low}"),
            (true, false) => write!(f, "more than {low}, at most {high}"),
            (false, true) => write!(f, "{low} or more"),
            (false, false) => write!(f, "{low} to {high}"),
        }
    }
}

/// The number as a person would write it: very large and very small numbers with an exponent (1e300 instead of 300 digits).
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
