//! Friction against rolling and spinning, as a robot's file states it.

use serde::{Deserialize, Serialize};

use super::absent::is_zero;
use super::flaw::{Checked, Range};

/// Friction against rolling and spinning: a couple between two shapes in contact, opposite to their relative rotation.
///
/// Both coefficients are lengths, as in MuJoCo: the largest couple over the normal force. Those of two shapes in contact add up,
/// and the floor's are parameters (`floor.rolling_m`, `floor.torsional_m`).
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "turning")]
pub struct TurningFriction {
    /// Largest couple against rolling over the normal force, metres.
    #[serde(skip_serializing_if = "is_zero")]
    pub rolling_m: f64,
    /// Largest couple against spinning about the normal over the normal force, metres.
    #[serde(skip_serializing_if = "is_zero")]
    pub torsional_m: f64,
}

impl TurningFriction {
    /// Smallest and largest coefficient, metres.
    pub const COEFFICIENTS_M: (f64, f64) = (0.0, 1.0);

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the range of every value; `at` is the path in the file.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        let (low, high) = Self::COEFFICIENTS_M;
        let values = [
            ("rolling_m", self.rolling_m),
            ("torsional_m", self.torsional_m),
        ];
        values.into_iter().try_for_each(|(field, value)| {
            Range::within(low, high, "m").check(value, &format!("{at}.{field}"))
        })
    }
}
