//! The world that a robot's file states around the robot: gravity, floor, and boxes beside it.

use serde::{Deserialize, Serialize};

use super::super::flaw::{Checked, Flaw, Range};
use super::super::module::check_name;
use super::super::turning::TurningFriction;
use super::check::check_pose;
use super::{Pose, Triple};
use realgap_core::Error;

/// The largest number of bodies beside a robot.
const MOST_BODIES: usize = 1000;

/// The world around a robot. An experiment begins with it; parameters of the same name replace its values.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "world")]
pub struct Surroundings {
    /// Magnitude of gravity along -z of the world, m/s2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<f64>,
    /// Coulomb friction coefficient of the pair robot and floor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_friction: Option<f64>,
    /// Rolling friction of the floor, metres: the largest couple over the normal force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_rolling_m: Option<f64>,
    /// Torsional friction of the floor, metres: the largest couple about the normal over the normal force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_torsional_m: Option<f64>,
    /// Height of the floor at the world origin, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_height_m: Option<f64>,
    /// Slope of the floor about world y, radians; positive is downhill towards +x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_slope_rad: Option<f64>,
    /// Longest timestep with which the springs and servos of the robot are followed, seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timestep_s: Option<f64>,
    /// Bodies beside the robot.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<Beside>,
}

/// A body beside the robot, which consists of boxes.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "beside")]
pub struct Beside {
    /// Name: letters, digits, `_` and `-`.
    pub name: String,
    /// Pose of the body at the start, in the world.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
    /// Its boxes.
    pub boxes: Vec<BesideBox>,
    /// Coulomb friction coefficient of the pair robot and body.
    pub friction: f64,
    /// Mass of a body that moves, kg; without it the body does not move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
}

/// A box of a body beside the robot.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "beside_box")]
pub struct BesideBox {
    /// Edges along x, y and z, metres.
    pub sides_m: Triple,
    /// Pose in the body's frame.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
}

impl Surroundings {
    /// Whether nothing is stated.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the range of every value.
    pub(super) fn check(&self) -> Checked<()> {
        let lengths_m = TurningFriction::COEFFICIENTS_M;
        let values = [
            ("gravity_m_s2", self.gravity_m_s2, (0.0, 100.0), "m/s^2"),
            ("floor_friction", self.floor_friction, (0.0, 10.0), ""),
            ("floor_rolling_m", self.floor_rolling_m, lengths_m, "m"),
            ("floor_torsional_m", self.floor_torsional_m, lengths_m, "m"),
            ("floor_height_m", self.floor_height_m, (-10.0, 10.0), "m"),
            ("floor_slope_rad", self.floor_slope_rad, (-1.2, 1.2), "rad"),
            ("timestep_s", self.timestep_s, (1e-6, 0.1), "s"),
        ];
        for (field, value, (low, high), unit) in values {
            if let Some(value) = value {
                Range::within(low, high, unit).check(value, &format!("world.{field}"))?;
            }
        }
        if self.bodies.len() > MOST_BODIES {
            return Err(Flaw::new(
                "world.bodies",
                Error::invalid("too many bodies beside the robot")
                    .found(self.bodies.len())
                    .allowed(format!("at most {MOST_BODIES}")),
            ));
        }
        for (index, body) in self.bodies.iter().enumerate() {
            body.check(&format!("world.bodies[{index}]"))?;
        }
        Ok(())
    }
}

impl Beside {
    fn check(&self, at: &str) -> Checked<()> {
        check_name(&self.name, "a body", &format!("{at}.name"))?;
        check_pose(&self.pose, &format!("{at}.pose"))?;
        Range::within(0.0, 10.0, "").check(self.friction, &format!("{at}.friction"))?;
        if let Some(mass_kg) = self.mass_kg {
            Range::within(1e-6, 1000.0, "kg").check(mass_kg, &format!("{at}.mass_kg"))?;
        }
        if self.boxes.is_empty() {
            return Err(Flaw::new(
                format!("{at}.boxes"),
                Error::invalid("a body without boxes").allowed("at least one box"),
            ));
        }
        for (index, part) in self.boxes.iter().enumerate() {
            let at = format!("{at}.boxes[{index}]");
            check_pose(&part.pose, &format!("{at}.pose"))?;
            let sides = [part.sides_m.0, part.sides_m.1, part.sides_m.2];
            for (axis, side_m) in sides.into_iter().enumerate() {
                let at = format!("{at}.sides_m[{axis}]");
                Range::within(1e-4, 100.0, "m").check(side_m, &at)?;
            }
        }
        Ok(())
    }
}
