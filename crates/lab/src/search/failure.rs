//! Failures: why a robot has no fitness.

use std::fmt;

use serde::{Deserialize, Serialize};

realgap_core::labelled_enum! {
    /// Kind of a failure.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "kebab-case")]
    Reason.code;
    /// The genome builds no robot.
    DoesNotDevelop "does-not-develop";
    /// A plate hits its own robot when it follows its gait.
    PlateBlocked "plate-blocked";
    /// The robot keeps on moving when it is put down.
    NotSettled "not-settled";
    /// The robot falls onto another side when it is put down.
    Toppled "toppled";
    /// The state of the simulation became unphysical.
    Diverged "diverged";
    /// The robot left the floor by more than the rules allow.
    Flying "flying";
    /// Parts of the robot went into each other by more than the rules allow.
    SelfPenetrating "self-penetrating";
    /// The expected fitness of the best gait that was found for the body is too low for the body to be judged.
    GoesNowhere "goes-nowhere";
}

impl Reason {
    /// The reason of this short name; `None` for any other text.
    pub(crate) fn by_code(code: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|reason| reason.code() == code)
    }
}

/// A failure: its kind, and what was observed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// The kind.
    pub reason: Reason,
    /// The observation.
    pub seen: String,
}

impl Failure {
    /// A failure.
    pub fn new(reason: Reason, seen: impl fmt::Display) -> Self {
        Self {
            reason,
            seen: seen.to_string(),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.reason.code(), self.seen)
    }
}

/// Rules for failures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FailureRules {
    /// Whether a robot fails if its plate would hit the robot itself.
    pub plate_blocked: bool,
    /// Whether a robot fails if it does not stand as it was placed (it keeps moving, or topples).
    pub unstable: bool,
    /// A robot flies when its lowest point is higher above the floor than this, in body lengths.
    pub flight_body_lengths: f64,
    /// Deepest that two parts may be inside each other, in body lengths.
    pub overlap_body_lengths: f64,
}

impl Default for FailureRules {
    /// The limits are assumptions: a walking cube hops by millimetres, and the contact model lets boxes overlap by less than one.
    fn default() -> Self {
        Self {
            plate_blocked: true,
            unstable: true,
            flight_body_lengths: 1.0,
            overlap_body_lengths: 0.1,
        }
    }
}
