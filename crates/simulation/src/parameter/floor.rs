//! Parameters of the floor and of gravity, and of single regions and steps of the ground: `floor.NAME.friction`.

use super::member::ANY;
use super::{Nudge, Parameter, entry, field};
use crate::Experiment;
use realgap_robot::morphology::TurningFriction;
use realgap_sensing::arena::{Ground, Region, Step};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("floor.friction", One, (0.0, 10.0), Linear, Nudge::Share(0.1),
        "Coulomb friction coefficient of the pair robot and floor.", floor.friction),
    field!("floor.restitution", One, (0.0, 1.0), Linear, Nudge::Absolute(0.05),
        "Restitution coefficient of the pair robot and floor.", floor.restitution),
    entry!("floor.rolling_m", Metre, TurningFriction::COEFFICIENTS_M, Linear, Nudge::Absolute(1e-4),
        "Rolling friction of the floor: the largest couple against rolling over the normal force, to which that of a shape is added; tree engine only.",
        |e, _| Some(e.floor.rolling_m.unwrap_or(0.0)), |e, _, value| e.floor.rolling_m = Some(value)),
    entry!("floor.torsional_m", Metre, TurningFriction::COEFFICIENTS_M, Linear, Nudge::Absolute(1e-4),
        "Torsional friction of the floor: the largest couple against spinning about the normal over the normal force, to which that of a shape is added; tree engine only.",
        |e, _| Some(e.floor.torsional_m.unwrap_or(0.0)), |e, _, value| e.floor.torsional_m = Some(value)),
    field!("floor.height_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "Height of the floor at the world origin.", floor.height_m),
    field!("floor.slope_rad", Radian, (-1.2, 1.2), Linear, Nudge::Absolute(0.01),
        "Slope of the floor about world y; positive is downhill towards +x.", floor.slope_rad),
    field!("floor.heights_scale", One, (0.0, 100.0), Linear, Nudge::Share(0.1),
        "Factor on the heights of an arena's height field.", heights_scale),
    field!("gravity_m_s2", MetrePerSecondSquared, (0.0, 100.0), Linear, Nudge::Share(0.01),
        "Magnitude of gravity, along -z of the world.", gravity_m_s2),
];

fn region<'a>(experiment: &'a Experiment, name: &str) -> Option<&'a Region> {
    let mut regions = experiment.ground.regions.iter();
    regions.find(|region| region.name == name)
}

fn step<'a>(experiment: &'a Experiment, name: &str) -> Option<&'a Step> {
    experiment
        .ground
        .steps
        .iter()
        .find(|step| step.name == name)
}

fn change_region(experiment: &mut Experiment, name: &str, to: impl Fn(&mut Region)) {
    let regions = experiment.ground.regions.iter_mut();
    regions.filter(|region| region.name == name).for_each(to);
}

fn change_step(experiment: &mut Experiment, name: &str, to: impl Fn(&mut Step)) {
    let steps = experiment.ground.steps.iter_mut();
    steps.filter(|step| step.name == name).for_each(to);
}

/// Parameters of one region or step of the ground.
#[rustfmt::skip] // a table
pub(super) static FAMILY: &[Parameter] = &[
    Parameter {
        subject: ANY,
        ..entry!("floor.NAME.friction", One, (0.0, 10.0), Linear, Nudge::Share(0.1),
            "Coulomb friction coefficient of the pair robot and the region or step NAME of the ground.",
            |e, name| region(e, name).map(|r| r.friction).or_else(|| step(e, name).map(|s| s.friction)),
            |e, name, value| {
                change_region(e, name, |region| region.friction = value);
                change_step(e, name, |step| step.friction = value);
            })
    },
    Parameter {
        subject: ANY,
        ..entry!("floor.NAME.restitution", One, (0.0, 1.0), Linear, Nudge::Absolute(0.05),
            "Restitution coefficient of the pair robot and the region NAME of the floor.",
            |e, name| region(e, name).map(|region| region.restitution.unwrap_or(e.floor.restitution)),
            |e, name, value| change_region(e, name, |region| region.restitution = Some(value)))
    },
    Parameter {
        subject: ANY,
        ..entry!("floor.NAME.height_m", Metre, Ground::STEP_HEIGHTS_M, Linear, Nudge::Absolute(0.001),
            "Height of the step NAME above the floor.",
            |e, name| step(e, name).map(|step| step.height_m),
            |e, name, value| change_step(e, name, |step| step.height_m = value))
    },
];
