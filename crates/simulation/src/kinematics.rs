//! Forward kinematics: poses and velocities of all parts for given joint coordinates.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::experiment::JointState;
use realgap_robot::morphology::{Assembly, Freedom};

/// Robot-frame pose of a part's own frame at zero angles: the centre of its first solid, axes of the robot.
pub(super) fn robot_from_part_at_zero(assembly: &Assembly, part: usize) -> Isometry3<f64> {
    let origin = assembly.parts[part].solids[0].robot_from_solid.translation;
    Isometry3::from_parts(origin, UnitQuaternion::identity())
}

/// The mass of a part whose weight is compensated, kg, and its centre in the part's frame, metres; a mass of 0 if there is none.
pub(super) fn compensated(assembly: &Assembly, part: usize) -> (f64, Vector3<f64>) {
    let (mass_kg, centre_robot_m) = assembly.parts[part].compensated().unwrap_or_default();
    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
    (
        mass_kg,
        (part_from_robot * Point3::from(centre_robot_m)).coords,
    )
}

/// Velocity of a rigid body (a twist): from it follow the velocities of all its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// Angular velocity, world frame, rad/s.
    pub angular_world_rad_s: Vector3<f64>,
    /// Velocity of the point at the world's origin, m/s.
    pub at_origin_world_m_s: Vector3<f64>,
}

impl Turn {
    /// No motion.
    pub(crate) const REST: Self = Self {
        angular_world_rad_s: Vector3::new(0.0, 0.0, 0.0),
        at_origin_world_m_s: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Velocity of a point of the body, world frame, m/s.
    pub fn velocity_at(&self, point_world_m: &Vector3<f64>) -> Vector3<f64> {
        self.at_origin_world_m_s + self.angular_world_rad_s.cross(point_world_m)
    }
}

/// For each part the velocity relative to the root that is due to the motion of the joints.
pub(super) fn joint_turns(
    assembly: &Assembly,
    world_from_parts: &[Isometry3<f64>],
    joints: &[JointState],
) -> Vec<Turn> {
    let mut turns = vec![Turn::REST; assembly.parts.len()];
    for (hinge, joint) in assembly.hinges.iter().zip(joints) {
        let mut turn = turns[hinge.parent_part];
        if joint.speed_rad_s != 0.0 {
            let parent = &world_from_parts[hinge.parent_part];
            let part_from_robot = robot_from_part_at_zero(assembly, hinge.parent_part).inverse();
            let anchor_m = parent * part_from_robot * Point3::from(hinge.anchor_robot_m);
            let rate = parent.rotation * hinge.axis_robot.into_inner() * joint.speed_rad_s;
            match hinge.freedom {
                Freedom::Turn => {
                    turn.angular_world_rad_s += rate;
                    turn.at_origin_world_m_s -= rate.cross(&anchor_m.coords);
                }
                Freedom::Slide => turn.at_origin_world_m_s += rate,
            }
        }
        turns[hinge.child_part] = turn;
    }
    turns
}

/// Robot-frame poses of all part frames at the given hinge angles, part 0 at its zero pose.
pub(super) fn robot_from_parts(assembly: &Assembly, angles_rad: &[f64]) -> Vec<Isometry3<f64>> {
    let moved = assembly.moved(angles_rad);
    (0..assembly.parts.len())
        .map(|part| moved[part] * robot_from_part_at_zero(assembly, part))
        .collect()
}

/// Pose of the tracked module in the frame of the part that carries it.
pub(super) fn part_from_track(assembly: &Assembly) -> Isometry3<f64> {
    robot_from_part_at_zero(assembly, assembly.track_part).inverse() * assembly.robot_from_track
}

/// Smallest signed distance of the robot's shapes to the plane through the origin with this unit normal, metres; that of the
/// parts' origins if no shape has a surface.
pub(super) fn lowest_m(
    assembly: &Assembly,
    parts: &[Isometry3<f64>],
    normal: &Vector3<f64>,
) -> f64 {
    let mut lowest = f64::INFINITY;
    for (part, robot_from_part) in parts.iter().enumerate() {
        let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
        for solid in assembly.parts[part]
            .solids
            .iter()
            .filter(|s| s.has_surface())
        {
            let pose = robot_from_part * part_from_robot * solid.robot_from_solid;
            let along = pose.rotation.inverse() * normal;
            let reach = solid.shape.reach_m(&-along);
            lowest = lowest.min(pose.translation.vector.dot(normal) - reach);
        }
    }
    if lowest.is_finite() {
        return lowest;
    }
    let heights = parts.iter().map(|pose| pose.translation.vector.dot(normal));
    heights.fold(f64::INFINITY, f64::min)
}
