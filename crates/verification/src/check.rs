//! The result of one check: a simulated value compared with the value of a closed-form formula.

use serde::Serialize;

use realgap_core::unit::Unit;

/// How far a measured value may be from the expected one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Tolerance {
    /// The tolerance is a share of the expected value.
    Relative(f64),
    /// The tolerance is in the unit of the check.
    Absolute(f64),
}

/// Whether a check passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CheckResult {
    /// The error is within the tolerance.
    Pass,
    /// The error exceeds the tolerance, or the simulation diverged.
    Fail,
}

/// One closed-form check and its outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Check {
    /// Stable name, `theme.check[.case][.joint kind]`.
    pub name: String,
    /// What is measured, and the closed form it is compared with.
    pub what: String,
    /// The closed form's value.
    pub expected: f64,
    /// The value in the simulation; not a number if the simulation diverged or the measured event did not occur.
    pub measured: f64,
    /// Difference between the measured and the expected value: absolute, or relative to the expected value, as the tolerance is.
    pub error: f64,
    /// Unit of expected and measured.
    pub unit: Unit,
    /// Largest error that passes. It follows from the accuracy that a user needs, not from the accuracy of the engine.
    pub tolerance: Tolerance,
    /// Whether the check passed.
    pub verdict: CheckResult,
}

impl Check {
    /// Compares `measured` with `expected`.
    pub fn new(
        name: impl Into<String>,
        what: impl Into<String>,
        expected: f64,
        measured: f64,
        unit: Unit,
        tolerance: Tolerance,
    ) -> Self {
        let difference = (measured - expected).abs();
        let (error, limit) = match tolerance {
            Tolerance::Relative(limit) => (difference / expected.abs(), limit),
            Tolerance::Absolute(limit) => (difference, limit),
        };
        // The comparison is written this way round so that an error that is not a number fails.
        let verdict = if error <= limit {
            CheckResult::Pass
        } else {
            CheckResult::Fail
        };
        Self {
            name: name.into(),
            what: what.into(),
            expected,
            measured,
            error,
            unit,
            tolerance,
            verdict,
        }
    }

    /// The error divided by the tolerance: a check passes up to 1.
    pub fn severity(&self) -> f64 {
        match self.tolerance {
            Tolerance::Relative(limit) | Tolerance::Absolute(limit) => self.error / limit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_or_absolute_as_the_tolerance_is() {
        let check = |measured, tolerance| {
            Check::new("a", "b", 2.0, measured, Unit::Metre, tolerance).verdict
        };
        assert_eq!(check(2.1, Tolerance::Relative(0.06)), CheckResult::Pass);
        assert_eq!(check(2.1, Tolerance::Absolute(0.06)), CheckResult::Fail);
        assert_eq!(check(1.8, Tolerance::Relative(0.06)), CheckResult::Fail);
        assert_eq!(check(f64::NAN, Tolerance::Relative(1.0)), CheckResult::Fail);
    }
}
