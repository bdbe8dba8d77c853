//! The start of wheels: a wheel with a tyre whose speed nobody states begins to roll as fast as the robot moves over the floor.

use nalgebra::{Isometry3, Vector3};

use super::engine::Motion;
use super::experiment::{Experiment, JointState};
use super::kinematics::robot_from_part_at_zero;
use realgap_robot::morphology::{Assembly, Freedom, Hinge, Shape, Solid};

/// Gives wheels with tyres, which would start at speed 0, the speed with which they roll without slip.
pub(super) fn start(
    experiment: &Experiment,
    assembly: &Assembly,
    world_from_parts: &[Isometry3<f64>],
    motion: Motion,
    joints: &mut [JointState],
) {
    let normal_world = experiment.floor.normal_world();
    for (hinge, joint) in assembly.hinges.iter().zip(joints) {
        if hinge.freedom != Freedom::Turn || joint.speed_rad_s != 0.0 {
            continue;
        }
        let mut solids = assembly.parts[hinge.child_part].solids.iter();
        let Some(tyre) = solids.find(|solid| solid.tyre.is_some()) else {
            continue;
        };
        let speed = speed_rad_s(
            hinge,
            tyre,
            assembly,
            world_from_parts,
            motion,
            normal_world,
        );
        joint.speed_rad_s = speed.unwrap_or(0.0);
    }
}

/// Speed of a wheel whose lowest point is at rest along its direction of rolling; `None` for a wheel that lies on its side.
fn speed_rad_s(
    hinge: &Hinge,
    tyre: &Solid,
    assembly: &Assembly,
    world_from_parts: &[Isometry3<f64>],
    motion: Motion,
    normal_world: Vector3<f64>,
) -> Option<f64> {
    let moved =
        |part: usize| world_from_parts[part] * robot_from_part_at_zero(assembly, part).inverse();
    let hub_m = (moved(hinge.child_part) * tyre.robot_from_solid)
        .translation
        .vector;
    let arm_m = hub_m - motion.about_world_m;
    let hub_m_s = motion.linear_world_m_s + motion.angular_world_rad_s.cross(&arm_m);
    let axis_world = moved(hinge.parent_part) * hinge.axis_robot.into_inner();
    let ahead = axis_world.cross(&normal_world);
    let upright = ahead.norm();
    (upright > 0.1).then(|| hub_m_s.dot(&ahead) / (upright * upright * radius_m(&tyre.shape)))
}

fn radius_m(shape: &Shape) -> f64 {
    match shape {
        Shape::Sphere { radius_m }
        | Shape::Cylinder { radius_m, .. }
        | Shape::Capsule { radius_m, .. } => *radius_m,
        other => other.half_extents_m().max(),
    }
}
