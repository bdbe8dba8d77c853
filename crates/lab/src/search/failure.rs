//! Why a robot has no fitness.

use std::fmt;

use serde::{Deserialize, Serialize};

realgap_core::labelled_enum! {
    /// What went wrong, by kind.
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
    /// The simulation's state became absurd.
    Diverged "diverged";
    /// The robot left the floor by more than the rules allow.
    Flying "flying";
    /// Parts of the robot went into each other by more than the rules allow.
    SelfPenetrating "self-penetrating";
    /// The best gait that was found for the body promises too little to be judged.
    GoesNowhere "goes-nowhere";
}

impl Reason {
    /// The reason of this short name; `None` for any other text.
    pub fn by_code(code: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|reason| reason.code() == code)
    }
}

/// A failure: the kind and what was seen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// The kind.
    pub reason: Reason,
    /// What was seen.
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

/// What counts as a failure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FailureRules {
    /// Whether a robot fails whose plate would hit itself.
    pub plate_blocked: bool,
    /// Whether a robot fails that does not stand as it was put down (still moving, or toppled).
    pub unstable: bool,
    /// A robot flies when its lowest point is higher above the floor than this, in body lengths.
    pub flight_body_lengths: f64,
    /// Deepest that two parts may be inside each other, in body lengths.
    pub overlap_body_lengths: f64,
}

impl Default for FailureRules {
    /// Assumed: a walking cube hops by millimetres, and the contact model lets boxes sink into each other by less than one.
    fn default() -> Self {
        Self {
            plate_blocked: true,
            unstable: true,
            flight_body_lengths: 1.0,
            overlap_body_lengths: 0.1,
        }
    }
}
