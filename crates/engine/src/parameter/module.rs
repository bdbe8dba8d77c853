//! Parameters of one module (or stated body): a family, `module.NAME.quantity`, with a member for every name.

use super::member::ANY;
use super::{Nudge, Parameter, Scale};
use crate::{Experiment, ModuleAdjustment};
use realgap_core::unit::Unit;

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

/// The family; `subject` is [`ANY`].
pub(super) static FAMILY: &[Parameter] = &[
    Parameter {
        name: "module.NAME.mass_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.05),
        doc: "Factor on the mass of the module NAME; inertia follows.",
        subject: ANY,
        get: |e, name| Some(read(e, name).mass_scale),
        set: |e, name, value| change(e, name).mass_scale = value,
    },
    Parameter {
        name: "module.NAME.inertia_x_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.05),
        doc: "Further factor on the inertia of the module NAME about its own x axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).inertia_scale.x),
        set: |e, name, value| change(e, name).inertia_scale.x = value,
    },
    Parameter {
        name: "module.NAME.inertia_y_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.05),
        doc: "Further factor on the inertia of the module NAME about its own y axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).inertia_scale.y),
        set: |e, name, value| change(e, name).inertia_scale.y = value,
    },
    Parameter {
        name: "module.NAME.inertia_z_scale",
        unit: Unit::One,
        bounds: (0.01, 100.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.05),
        doc: "Further factor on the inertia of the module NAME about its own z axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).inertia_scale.z),
        set: |e, name, value| change(e, name).inertia_scale.z = value,
    },
    Parameter {
        name: "module.NAME.com_offset_x_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.001),
        doc: "Shift of the centre of mass of the module NAME along its own x axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).centre_of_mass_offset_m.x),
        set: |e, name, value| change(e, name).centre_of_mass_offset_m.x = value,
    },
    Parameter {
        name: "module.NAME.com_offset_y_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.001),
        doc: "Shift of the centre of mass of the module NAME along its own y axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).centre_of_mass_offset_m.y),
        set: |e, name, value| change(e, name).centre_of_mass_offset_m.y = value,
    },
    Parameter {
        name: "module.NAME.com_offset_z_m",
        unit: Unit::Metre,
        bounds: (-1.0, 1.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(0.001),
        doc: "Shift of the centre of mass of the module NAME along its own z axis.",
        subject: ANY,
        get: |e, name| Some(read(e, name).centre_of_mass_offset_m.z),
        set: |e, name, value| change(e, name).centre_of_mass_offset_m.z = value,
    },
];
