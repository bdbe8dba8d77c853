//! Parameters of one module: a family, `module.NAME.quantity`, with a member for every name.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex};

use super::{Nudge, Parameter, Scale};
use crate::{Experiment, ModuleAdjustment};
use realgap_core::unit::Unit;

/// In place of the name of a module, in lists.
pub(super) const ANY: &str = "NAME";

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

/// The member of the family that a name means: `module.` a module's name `.` a quantity.
pub(super) fn member(name: &str) -> Option<&'static Parameter> {
    // A parameter is compared and stored by reference, so each name has one for as long as the program runs.
    static KNOWN: LazyLock<Mutex<BTreeMap<String, &'static Parameter>>> =
        LazyLock::new(Mutex::default);
    let (module, quantity) = name.strip_prefix("module.")?.split_once('.')?;
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if module.is_empty() || module.len() > 64 || !module.chars().all(is_name) {
        return None;
    }
    let family = FAMILY
        .iter()
        .find(|p| p.name.strip_prefix("module.NAME.") == Some(quantity))?;
    let mut known = KNOWN
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    Some(known.entry(name.to_owned()).or_insert_with(|| {
        Box::leak(Box::new(Parameter {
            name: Box::leak(name.to_owned().into_boxed_str()),
            subject: Box::leak(module.to_owned().into_boxed_str()),
            ..*family
        }))
    }))
}
