//! A look at a whole robot during a run: every part and every hinge, not the tracked module alone.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::kinematics::robot_from_part_at_zero;
use super::world::World;
use crate::error::{Error, Result};
use crate::robot::morphology::Assembly;

/// A velocity added to one loose part at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Index of the part.
    pub part: usize,
    /// Added velocity of its centre of mass, world frame, m/s.
    pub velocity_world_m_s: Vector3<f64>,
}

impl Push {
    pub(super) fn check(&self, assembly: &Assembly) -> Result<()> {
        let hinged = |part| {
            assembly
                .hinges
                .iter()
                .any(|hinge| hinge.parent_part == part || hinge.child_part == part)
        };
        if self.part < assembly.parts.len() && !hinged(self.part) {
            return Ok(());
        }
        Err(Error::invalid("only a part without hinges can be pushed")
            .field("part")
            .found(self.part)
            .allowed(format!(
                "a part below {} that no hinge holds",
                assembly.parts.len()
            )))
    }
}

/// One rigid part as the engine sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct PartState {
    /// Pose of the part frame (centre of its first solid, axes of the robot at zero angles).
    pub world_from_part: Isometry3<f64>,
    /// Centre of mass, world frame, metres.
    pub centre_world_m: Vector3<f64>,
    /// Velocity of the centre of mass, world frame, m/s.
    pub velocity_world_m_s: Vector3<f64>,
    /// Angular velocity, world frame, rad/s.
    pub angular_velocity_world_rad_s: Vector3<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia about the centre of mass, along the world's axes, kg m².
    pub inertia_world_kg_m2: Matrix3<f64>,
}

impl PartState {
    /// Kinetic energy, J.
    pub fn kinetic_energy_j(&self) -> f64 {
        let spin = self.angular_velocity_world_rad_s;
        0.5 * self.mass_kg * self.velocity_world_m_s.norm_squared()
            + 0.5 * spin.dot(&(self.inertia_world_kg_m2 * spin))
    }

    /// Momentum, kg m/s.
    pub fn momentum_world_kg_m_s(&self) -> Vector3<f64> {
        self.velocity_world_m_s * self.mass_kg
    }

    /// Angular momentum about the world's origin, kg m²/s.
    pub fn angular_momentum_world_kg_m2_s(&self) -> Vector3<f64> {
        self.inertia_world_kg_m2 * self.angular_velocity_world_rad_s
            + self.centre_world_m.cross(&self.momentum_world_kg_m_s())
    }
}

/// One hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeState {
    /// Angle, radians, within half a turn.
    pub angle_rad: f64,
    /// Distance between the two points that the hinge should keep together, metres.
    pub opening_m: f64,
    /// Angle between the two axes that the hinge should keep parallel, radians.
    pub tilt_rad: f64,
}

/// The robot at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Time, seconds from the start.
    pub time_s: f64,
    /// Parts, in the assembly's order.
    pub parts: Vec<PartState>,
    /// Hinges, in the assembly's order.
    pub hinges: Vec<HingeState>,
}

impl Snapshot {
    pub(super) fn take(time_s: f64, assembly: &Assembly, world: &World) -> Self {
        let parts: Vec<PartState> = (0..assembly.parts.len())
            .map(|part| world.part_state(part))
            .collect();
        let hinges = assembly
            .hinges
            .iter()
            .enumerate()
            .map(|(index, hinge)| {
                let held = |part: usize| {
                    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
                    let anchor = part_from_robot * Point3::from(hinge.anchor_robot_m);
                    let pose = &parts[part].world_from_part;
                    (pose * anchor, pose * hinge.axis_robot.into_inner())
                };
                let (a, b) = (held(hinge.parent_part), held(hinge.child_part));
                HingeState {
                    angle_rad: world.hinge_angle_rad(index, 0.0),
                    opening_m: (a.0 - b.0).norm(),
                    tilt_rad: a.1.cross(&b.1).norm().atan2(a.1.dot(&b.1)),
                }
            })
            .collect();
        Self {
            time_s,
            parts,
            hinges,
        }
    }
}
