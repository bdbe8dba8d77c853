//! Stated hinges, and bodies of the scene that are driven.

use super::{Nudge, Parameter, Scale, field};
use crate::{Experiment, SceneMotion};
use realgap_core::unit::Unit;
use realgap_robot::morphology::Bearing;

/// What the robot's file gives every stated hinge; `None` where they differ or there are none.
fn shared(experiment: &Experiment, own: impl Fn(&Bearing) -> f64) -> Option<f64> {
    let hinges = experiment.assembly.hinges.iter();
    same(hinges.filter(|h| h.is_stated).map(|h| own(&h.bearing)))
}

fn same(mut values: impl Iterator<Item = f64>) -> Option<f64> {
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

/// The friction that the study gives every driven body; `None` where they differ or there are none.
fn pusher_friction(experiment: &Experiment) -> Option<f64> {
    let bodies = experiment.scene.iter();
    let driven = bodies.filter(|body| matches!(body.motion, SceneMotion::Driven { .. }));
    same(driven.map(|body| body.friction))
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "hinge.viscous_nm_s_rad",
        unit: Unit::NewtonMetreSecondPerRadian,
        bounds: (0.0, 1000.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.1),
        doc: "Viscous friction of every stated hinge, in place of the robot file's.",
        subject: "",
        get: |e, _| {
            let own = |bearing: &Bearing| bearing.viscous_nm_s_rad;
            e.adjustment
                .hinge_viscous_nm_s_rad
                .or_else(|| shared(e, own))
        },
        set: |e, _, value| e.adjustment.hinge_viscous_nm_s_rad = Some(value),
    },
    Parameter {
        name: "hinge.dry_nm",
        unit: Unit::NewtonMetre,
        bounds: (0.0, 1000.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.1),
        doc: "Dry friction of every stated hinge, in place of the robot file's.",
        subject: "",
        get: |e, _| {
            let own = |bearing: &Bearing| bearing.dry_nm;
            e.adjustment.hinge_dry_nm.or_else(|| shared(e, own))
        },
        set: |e, _, value| e.adjustment.hinge_dry_nm = Some(value),
    },
    field!("pusher.offset_x_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own x axis.", adjustment.pusher_offset_m.x),
    field!("pusher.offset_y_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own y axis.", adjustment.pusher_offset_m.y),
    field!("pusher.offset_z_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the boxes of every driven body of the scene along the body's own z axis.", adjustment.pusher_offset_m.z),
    Parameter {
        name: "pusher.friction",
        unit: Unit::One,
        bounds: (0.0, 10.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.1),
        doc: "Coulomb friction coefficient of the pair robot and driven body, in place of the study's.",
        subject: "",
        get: |e, _| e.adjustment.pusher_friction.or_else(|| pusher_friction(e)),
        set: |e, _, value| e.adjustment.pusher_friction = Some(value),
    },
];
