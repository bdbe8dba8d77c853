//! The stand of a held robot, where it gives a little.

use nalgebra::{Isometry3, Point3};
use realgap_robot::morphology::Assembly;
use realgap_tree::{Attachment, MountSpring};

use super::experiment::Experiment;
use super::kinematics::robot_from_part_at_zero;
use super::rapier::{to_pose, to_vector};

/// Stiffness and damping of a stand, in all directions alike, at the place where the robot is held (the origin of its frame). At the start it
/// carries the robot's weight: the robot begins where its file holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mount {
    /// Force per displacement, N/m.
    pub stiffness_n_m: f64,
    /// Torque per rotation, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Damping as a time, s: damping over stiffness, of displacements and of rotations (a Kelvin–Voigt solid). At a natural angular
    /// frequency ω the damping ratio is half of ω times this time.
    pub damping_s: f64,
}

/// A stand so stiff that it hardly gives: what is not stated of a spring.
impl Default for Mount {
    fn default() -> Self {
        Self {
            stiffness_n_m: 1e7,
            stiffness_nm_rad: 1e6,
            damping_s: 1e-3,
        }
    }
}

impl Mount {
    /// Force per velocity, N s/m.
    pub fn damping_n_s_m(&self) -> f64 {
        self.damping_s * self.stiffness_n_m
    }

    /// Torque per angular velocity, N m s/rad.
    pub fn damping_nm_s_rad(&self) -> f64 {
        self.damping_s * self.stiffness_nm_rad
    }
}

/// How the root of a held robot is attached to the world: rigidly, or by a spring at the origin of the robot's frame.
pub(super) fn held(
    experiment: &Experiment,
    assembly: &Assembly,
    world_from_part: &Isometry3<f64>,
) -> Attachment {
    let world_from_link = to_pose(world_from_part);
    let Some(mount) = experiment.mount else {
        return Attachment::Mounted { world_from_link };
    };
    let part_from_robot = robot_from_part_at_zero(assembly, 0).inverse();
    Attachment::Sprung {
        world_from_link,
        spring: MountSpring {
            at_link_m: to_vector(&(part_from_robot * Point3::origin()).coords),
            stiffness_n_m: mount.stiffness_n_m,
            damping_n_s_m: mount.damping_n_s_m(),
            stiffness_nm_rad: mount.stiffness_nm_rad,
            damping_nm_s_rad: mount.damping_nm_s_rad(),
        },
    }
}
