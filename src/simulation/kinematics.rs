//! Where every part is, given the servo angles: forward kinematics of the hinge tree.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::robot::morphology::{Assembly, Hinge};

/// Robot-frame pose of a part's own frame at zero angles: the centre of its first solid, axes of the robot.
pub(super) fn robot_from_part_at_zero(assembly: &Assembly, part: usize) -> Isometry3<f64> {
    let origin = assembly.parts[part].solids[0].robot_from_solid.translation;
    Isometry3::from_parts(origin, UnitQuaternion::identity())
}

/// Turn by `angle_rad` about the hinge's axis, in the robot frame.
fn turn(hinge: &Hinge, angle_rad: f64) -> Isometry3<f64> {
    let there = Translation3::from(hinge.anchor_robot_m);
    let rotation = UnitQuaternion::from_axis_angle(&hinge.axis_robot, angle_rad);
    there * rotation * there.inverse()
}

/// Robot-frame poses of all part frames at the given hinge angles, part 0 at its zero pose.
pub(super) fn robot_from_parts(assembly: &Assembly, angles_rad: &[f64]) -> Vec<Isometry3<f64>> {
    let mut moved = vec![Isometry3::identity(); assembly.parts.len()];
    for (hinge, &angle_rad) in assembly.hinges.iter().zip(angles_rad) {
        moved[hinge.child_part] = moved[hinge.parent_part] * turn(hinge, angle_rad);
    }
    (0..assembly.parts.len())
        .map(|part| moved[part] * robot_from_part_at_zero(assembly, part))
        .collect()
}

/// Pose of the tracked module in the frame of the part that carries it.
pub(super) fn part_from_track(assembly: &Assembly) -> Isometry3<f64> {
    robot_from_part_at_zero(assembly, assembly.track_part).inverse() * assembly.robot_from_track
}

/// Smallest signed distance of the robot's collision boxes to the plane through the origin with this unit normal, metres.
pub(super) fn lowest_m(
    assembly: &Assembly,
    parts: &[Isometry3<f64>],
    normal: &Vector3<f64>,
) -> f64 {
    let mut lowest = f64::INFINITY;
    for (part, robot_from_part) in parts.iter().enumerate() {
        let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
        for solid in assembly.parts[part].solids.iter().filter(|s| s.collides) {
            let pose = robot_from_part * part_from_robot * solid.robot_from_solid;
            let along = pose.rotation.inverse() * normal;
            let reach = along.abs().dot(&solid.half_extents_m);
            lowest = lowest.min(pose.translation.vector.dot(normal) - reach);
        }
    }
    lowest
}
