//! The contact model of the solver.

use super::{Nudge, Parameter, Scale};
use crate::FrictionModel;
use realgap_core::unit::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "contact.prediction_m",
        unit: Unit::Metre,
        bounds: (0.0, 0.1),
        whole: false,
        scale: Scale::Linear,
        nudge: Nudge::Share(0.5),
        doc: "Distance at which contacts are predicted.",
        subject: "",
        get: |e, _| Some(e.contact.prediction_m),
        set: |e, _, value| e.contact.prediction_m = value,
    },
    Parameter {
        name: "contact.natural_frequency_hz",
        unit: Unit::Hertz,
        bounds: (0.1, 1e6),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.25),
        doc: "Stiffness of contact with the floor, as a natural frequency; among modules half of it.",
        subject: "",
        get: |e, _| Some(e.contact.natural_frequency_hz),
        set: |e, _, value| e.contact.natural_frequency_hz = value,
    },
    Parameter {
        name: "contact.damping_ratio",
        unit: Unit::One,
        bounds: (0.0, 1000.0),
        whole: false,
        scale: Scale::Log,
        nudge: Nudge::Share(0.25),
        doc: "Damping ratio of contacts; with the natural frequency it decides how fast penetration is pushed out.",
        subject: "",
        get: |e, _| Some(e.contact.damping_ratio),
        set: |e, _, value| e.contact.damping_ratio = value,
    },
    Parameter {
        name: "contact.friction_model",
        unit: Unit::One,
        bounds: (0.0, 1.0),
        whole: true,
        scale: Scale::Linear,
        nudge: Nudge::Absolute(1.0),
        doc: "0: Simplified, a friction pyramid per contact area; 1: Coulomb, a cone at every contact point.",
        subject: "",
        get: |e, _| {
            Some(match e.contact.friction_model {
                FrictionModel::Simplified => 0.0,
                FrictionModel::Coulomb => 1.0,
            })
        },
        set: |e, _, value| {
            e.contact.friction_model = if value == 0.0 {
                FrictionModel::Simplified
            } else {
                FrictionModel::Coulomb
            };
        },
    },
];
