//! The open-loop command.

use super::{Nudge, Parameter, Scale};
use realgap_core::unit::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "gait.frequency_scale",
        unit: Unit::One,
        bounds: (0.0, 100.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.02),
        doc: "Factor on every gait frequency.",
        subject: "",
        get: |e, _| Some(e.adjustment.frequency_scale),
        set: |e, _, value| e.adjustment.frequency_scale = value,
    },
    Parameter {
        name: "gait.amplitude_scale",
        unit: Unit::One,
        bounds: (0.0, 100.0),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.05),
        doc: "Factor on every gait amplitude.",
        subject: "",
        get: |e, _| Some(e.adjustment.amplitude_scale),
        set: |e, _, value| e.adjustment.amplitude_scale = value,
    },
];
