//! Parameters of one module (or body): a family `module.NAME.quantity` with a member for every name.

use super::member::ANY;
use super::{Nudge, Parameter, entry};
use crate::{Experiment, ModuleAdjustment};

fn read(experiment: &Experiment, module: &str) -> ModuleAdjustment {
    let known = experiment.module_adjustments.get(module);
    known.copied().unwrap_or_default()
}

fn change<'a>(experiment: &'a mut Experiment, module: &str) -> &'a mut ModuleAdjustment {
    experiment
        .module_adjustments
        .entry(module.to_owned())
        .or_default()
}

/// Defines a parameter for an adjustment of a module.
macro_rules! adjusted {
    ($name:literal, $unit:ident, $bounds:expr, $scale:ident, $nudge:expr, $doc:literal, $($field:ident).+) => {
        Parameter {
            subject: ANY,
            ..entry!($name, $unit, $bounds, $scale, $nudge, $doc,
                |e, name| Some(read(e, name).$($field).+),
                |e, name, value| change(e, name).$($field).+ = value)
        }
    };
}

/// The family of parameters; their `subject` is [`ANY`].
#[rustfmt::skip] // a table
pub(super) static FAMILY: &[Parameter] = &[
    adjusted!("module.NAME.mass_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Factor on the mass of the module NAME; inertia follows.", mass_scale),
    adjusted!("module.NAME.inertia_x_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Further factor on the inertia of the module NAME about its own x axis.", inertia_scale.x),
    adjusted!("module.NAME.inertia_y_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Further factor on the inertia of the module NAME about its own y axis.", inertia_scale.y),
    adjusted!("module.NAME.inertia_z_scale", One, (0.01, 100.0), Log, Nudge::Share(0.05),
        "Further factor on the inertia of the module NAME about its own z axis.", inertia_scale.z),
    adjusted!("module.NAME.inertia_stretch_x", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Logarithm of the factor by which the mass of the module NAME is spread along its own x axis: no value gives an inertia that no body has.", inertia_change.stretch.x),
    adjusted!("module.NAME.inertia_stretch_y", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Logarithm of the factor by which the mass of the module NAME is spread along its own y axis: no value gives an inertia that no body has.", inertia_change.stretch.y),
    adjusted!("module.NAME.inertia_stretch_z", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Logarithm of the factor by which the mass of the module NAME is spread along its own z axis: no value gives an inertia that no body has.", inertia_change.stretch.z),
    adjusted!("module.NAME.inertia_shear_xy", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Shear of the mass of the module NAME: how far what lies along its own y axis moves along x, which turns its principal axes.", inertia_change.shear.x),
    adjusted!("module.NAME.inertia_shear_yz", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Shear of the mass of the module NAME: how far what lies along its own z axis moves along y, which turns its principal axes.", inertia_change.shear.y),
    adjusted!("module.NAME.inertia_shear_xz", One, (-3.0, 3.0), Linear, Nudge::Absolute(0.02),
        "Shear of the mass of the module NAME: how far what lies along its own z axis moves along x, which turns its principal axes.", inertia_change.shear.z),
    adjusted!("module.NAME.com_offset_x_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the centre of mass of the module NAME along its own x axis.", centre_of_mass_offset_m.x),
    adjusted!("module.NAME.com_offset_y_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the centre of mass of the module NAME along its own y axis.", centre_of_mass_offset_m.y),
    adjusted!("module.NAME.com_offset_z_m", Metre, (-1.0, 1.0), Linear, Nudge::Absolute(0.001),
        "Shift of the centre of mass of the module NAME along its own z axis.", centre_of_mass_offset_m.z),
];
