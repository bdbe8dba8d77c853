//! The open-loop command.

use super::Parameter;
use crate::quantity::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "gait.frequency_scale",
        unit: Unit::One,
        bounds: (0.0, 100.0),
        whole: false,
        doc: "Factor on every gait frequency.",
        get: |e| Some(e.adjustment.frequency_scale),
        set: |e, value| e.adjustment.frequency_scale = value,
    },
    Parameter {
        name: "gait.amplitude_scale",
        unit: Unit::One,
        bounds: (0.0, 100.0),
        whole: false,
        doc: "Factor on every gait amplitude.",
        get: |e| Some(e.adjustment.amplitude_scale),
        set: |e, value| e.adjustment.amplitude_scale = value,
    },
];
