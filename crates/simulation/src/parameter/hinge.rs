//! Parameters of stated hinges and of driven bodies of the scene.

use super::member::{change, shared};
use super::{Nudge, Parameter, entry, field};
use crate::{Experiment, SceneMotion};

fn same(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

/// The friction of the driven bodies in the study; `None` if the values differ or there are no driven bodies.
fn pusher_friction(experiment: &Experiment) -> Option<f64> {
    let bodies = experiment.scene.iter();
    let driven = bodies.filter(|body| matches!(body.motion, SceneMotion::Driven { .. }));
    same(driven.map(|body| body.friction))
}

/// Defines a parameter for a property of stated hinges.
macro_rules! bearing {
    ($name:literal, $unit:ident, $doc:literal, $($field:ident).+) => {
        entry!(
            $name,
            $unit,
            (0.0, 1000.0),
            Linear,
            Nudge::Share(0.1),
            $doc,
            |e, of| shared(e, of, |h, _| h.is_stated.then_some(h.bearing.$($field).+)),
            |e, of, value| {
                change(e, of, |hinge| {
                    if hinge.is_stated {
                        hinge.bearing.$($field).+ = value;
                    }
                })
            }
        )
    };
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    bearing!("hinge.viscous_nm_s_rad", NewtonMetreSecondPerRadian,
        "Viscous friction of every stated hinge, in place of the robot file's.", viscous_nm_s_rad),
    bearing!("hinge.dry_nm", NewtonMetre,
        "Dry friction of every stated hinge, in place of the robot file's. Also called hinge.dry_friction_nm.", dry_nm),
    bearing!("hinge.armature_kg_m2", KilogramSquareMetre,
        "Inertia that resists only the motion of the hinge itself (armature), for every stated hinge, in place of the robot file's.", armature_kg_m2),
    bearing!("hinge.bearing_hz", Hertz,
        "Stiffness of the bearing of every stated hinge in the directions that it constrains, as the natural frequency of its two parts alone; 0: rigid. In Rapier's impulse joints only.", compliance.frequency_hz),
    bearing!("hinge.bearing_ratio", One,
        "Damping ratio of a compliant bearing; it needs hinge.bearing_hz.", compliance.damping_ratio),
    field!("pusher.offset_x_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own x axis.", adjustment.pusher_offset_m.x),
    field!("pusher.offset_y_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own y axis.", adjustment.pusher_offset_m.y),
    field!("pusher.offset_z_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own z axis.", adjustment.pusher_offset_m.z),
    entry!("pusher.friction", One, (0.0, 10.0), Linear, Nudge::Share(0.1),
        "Coulomb friction coefficient of the pair robot and driven body, in place of the study's.",
        |e, _| e.adjustment.pusher_friction.or_else(|| pusher_friction(e)),
        |e, _, value| e.adjustment.pusher_friction = Some(value)),
];
