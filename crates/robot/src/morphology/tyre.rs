//! The tyre of a wheel, as a robot's file states it.

use serde::{Deserialize, Serialize};

use super::flaw::{Checked, Range};

/// A shape that is a tyre: its friction grows with the slip, up to Coulomb's limit.
///
/// The friction force over the load is µ sin(shape · atan(slip stiffness · slip / (shape · µ))), opposite to the slip (Pacejka, *Tire and
/// Vehicle Dynamics*, 2012, section 4.3, without curvature and offsets). The slip is the velocity of the surface against the floor
/// over the speed of travel, along and across the wheel alike; for a small slip across it is the slip angle.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "tyre")]
pub struct Tyre {
    /// Friction force per load and per slip while the slip is small, 1/rad; it does not depend on the friction coefficient.
    pub slip_stiffness_1_rad: f64,
    /// Shape of the curve, from 1 (the force grows up to the limit) to below 2 (it falls again at larger slips).
    #[serde(default = "usual", skip_serializing_if = "is_usual")]
    pub shape: f64,
}

/// The shape of a curve whose force falls by a fifth beyond its peak.
fn usual() -> f64 {
    1.4
}

// serde passes fields by reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_usual(shape: &f64) -> bool {
    *shape == usual()
}

impl Tyre {
    /// Smallest and largest slip stiffness, 1/rad.
    pub const SLIP_STIFFNESSES: (f64, f64) = (0.01, 1e5);
    /// Smallest and largest shape.
    pub const SHAPES: (f64, f64) = (1.0, 1.99);

    /// Checks the range of every value; `at` is the path in the file.
    pub(super) fn check(&self, at: &str) -> Checked<()> {
        let (low, high) = Self::SLIP_STIFFNESSES;
        let path = format!("{at}.slip_stiffness_1_rad");
        Range::within(low, high, "1/rad").check(self.slip_stiffness_1_rad, &path)?;
        let (low, high) = Self::SHAPES;
        Range::within(low, high, "").check(self.shape, &format!("{at}.shape"))
    }
}
