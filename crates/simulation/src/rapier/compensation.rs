//! Forces upwards that compensate a share of the weight of parts.

use nalgebra::{Point3, Vector3};
use rapier3d_f64::prelude::{RigidBodyHandle, RigidBodySet};

use super::super::kinematics::compensated;
use super::RapierPart;
use super::pose::{from_pose, to_vector};
use realgap_robot::morphology::Assembly;

/// The force that compensates weight of one part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Compensation {
    pub body: RigidBodyHandle,
    /// Where the force acts, in the frame of the engine's body, metres.
    pub place_body_m: Vector3<f64>,
    /// Mass whose weight the force carries, kg.
    pub mass_kg: f64,
}

impl Compensation {
    /// The forces of the parts of a robot whose weight is compensated.
    pub fn of(assembly: &Assembly, parts: &[RapierPart]) -> Vec<Self> {
        let each = parts.iter().enumerate().map(|(index, part)| {
            let (mass_kg, centre_part_m) = compensated(assembly, index);
            Self {
                body: part.body,
                place_body_m: centre_part_m - part.centre_part_m,
                mass_kg,
            }
        });
        each.filter(|one| one.mass_kg != 0.0).collect()
    }

    /// Applies the forces for the next step.
    pub fn push(all: &[Self], bodies: &mut RigidBodySet, gravity_m_s2: f64) {
        for one in all {
            if let Some(body) = bodies.get_mut(one.body) {
                let place = from_pose(body.position()) * Point3::from(one.place_body_m);
                let force_n = Vector3::new(0.0, 0.0, one.mass_kg * gravity_m_s2);
                body.add_force_at_point(to_vector(&force_n), to_vector(&place.coords), true);
            }
        }
    }

    /// Removes the forces, because they are valid for one step only.
    pub fn reset(all: &[Self], bodies: &mut RigidBodySet) {
        for one in all {
            if let Some(body) = bodies.get_mut(one.body) {
                body.reset_forces(false);
                body.reset_torques(false);
            }
        }
    }
}
