//! The stand of a held robot, and missing contacts, in MJCF.

use nalgebra::{UnitQuaternion, Vector3};

use super::robot::Robot;
use super::xml::{Element, numbers, vector};
use crate::rapier::total_kg;

/// The options, with contacts switched off where the experiment has none.
pub(super) fn switched(robot: &Robot<'_>, option: Element) -> Element {
    match robot.has_contacts {
        true => option,
        false => option.child(Element::new("flag").with("contact", "disable")),
    }
}

/// The joints by which a held robot hangs on its stand, if that is a spring: slides along the axes of the world, where the one that
/// gravity loads carries the robot's weight, and a ball joint at the place where it is held.
pub(super) fn stand(
    robot: &Robot<'_>,
    world_from_robot: &UnitQuaternion<f64>,
    origin_m: &Vector3<f64>,
) -> Vec<Element> {
    let Some(mount) = robot.mount else {
        return Vec::new();
    };
    let weight_n = robot.gravity_m_s2 * total_kg(&robot.assembly);
    let slide = |(name, axis_world, load_n): (&str, Vector3<f64>, f64)| {
        Element::new("joint")
            .with("name", format!("stand.{name}"))
            .with("type", "slide")
            .with("axis", vector(&(world_from_robot.inverse() * axis_world)))
            .with("stiffness", numbers([mount.stiffness_n_m]))
            .with("damping", numbers([mount.damping_n_s_m()]))
            .with("springref", numbers([load_n / mount.stiffness_n_m]))
    };
    let axes = [
        ("x", Vector3::x(), 0.0),
        ("y", Vector3::y(), 0.0),
        ("z", Vector3::z(), weight_n),
    ];
    let ball = Element::new("joint")
        .with("name", "stand.turn")
        .with("type", "ball")
        .with("pos", vector(&-origin_m))
        .with("stiffness", numbers([mount.stiffness_nm_rad]))
        .with("damping", numbers([mount.damping_nm_s_rad()]));
    axes.into_iter().map(slide).chain([ball]).collect()
}
