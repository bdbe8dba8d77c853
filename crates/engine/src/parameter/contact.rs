//! The contact model of the solver.

use super::{Nudge, Parameter, Scale, field};
use crate::FrictionModel;
use realgap_core::unit::Unit;

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("contact.prediction_m", Metre, (0.0, 0.1), Linear, Nudge::Share(0.5),
        "Distance at which contacts are predicted.", contact.prediction_m),
    field!("contact.natural_frequency_hz", Hertz, (0.1, 1e6), Log, Nudge::Share(0.25),
        "Stiffness of contact with the floor, as a natural frequency; among modules half of it.", contact.natural_frequency_hz),
    field!("contact.damping_ratio", One, (0.0, 1000.0), Log, Nudge::Share(0.25),
        "Damping ratio of contacts; with the natural frequency it decides how fast penetration is pushed out.", contact.damping_ratio),
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
