//! The ground under a robot and the gravity, where the robot's file states them.

use serde::{Deserialize, Serialize};

/// What a robot's file states about the world around the robot: an experiment with the robot begins with these values, and its
/// parameters (`floor.friction`, `floor.height_m`, `floor.slope_rad`, `gravity_m_s2`) replace them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "ground")]
pub struct Ground {
    /// Coulomb friction coefficient of the pair robot-floor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Height of the floor at the world origin, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    /// Slope of the floor about the world y axis, radians; positive: downhill towards +x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope_rad: Option<f64>,
    /// Magnitude of gravity, along -z of the world, m/s².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<f64>,
}

/// The steepest slope of a floor, radians.
const STEEPEST_RAD: f64 = 1.4;

impl Ground {
    /// The first value that no world has: its name, the value, and what is allowed.
    pub(super) fn flaw(&self) -> Option<(&'static str, f64, &'static str)> {
        let checks = [
            ("friction", self.friction, 0.0..=10.0, "0 to 10"),
            ("height_m", self.height_m, -100.0..=100.0, "-100 to 100 m"),
            (
                "slope_rad",
                self.slope_rad,
                -STEEPEST_RAD..=STEEPEST_RAD,
                "-1.4 to 1.4 rad",
            ),
            ("gravity_m_s2", self.gravity_m_s2, 0.0..=100.0, "0 to 100 m/s2"),
        ];
        checks.into_iter().find_map(|(name, found, allowed, words)| {
            found
                .filter(|value| !allowed.contains(value))
                .map(|value| (name, value, words))
        })
    }
}
