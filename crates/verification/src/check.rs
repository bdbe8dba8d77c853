//! One comparison of the simulation with a closed form.

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
    /// It is not, or the simulation diverged.
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
    /// What the simulation did; not a number where it diverged or the event never came.
    pub measured: f64,
    /// Distance of the two, in the terms of the tolerance: a share or a difference.
    pub error: f64,
    /// Unit of expected and measured.
    pub unit: Unit,
    /// Largest error that passes; set by what a user needs, not by what the engine reaches.
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
        // Written so that a value that is not a number fails.
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

    /// Error in units of the tolerance: up to 1 passes.
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
    fn errors_are_judged_in_the_terms_of_the_tolerance() {
        let check = |measured, tolerance| {
            Check::new("a", "b", 2.0, measured, Unit::Metre, tolerance).verdict
        };
        assert_eq!(check(2.1, Tolerance::Relative(0.06)), CheckResult::Pass);
        assert_eq!(check(2.1, Tolerance::Absolute(0.06)), CheckResult::Fail);
        assert_eq!(check(1.8, Tolerance::Relative(0.06)), CheckResult::Fail);
        assert_eq!(check(f64::NAN, Tolerance::Relative(1.0)), CheckResult::Fail);
    }
}
