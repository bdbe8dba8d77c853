//! Parameters of the contact model.

use super::{Nudge, Parameter, choice, field};
use crate::FrictionModel;

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("contact.prediction_m", Metre, (0.0, 0.1), Linear, Nudge::Share(0.5),
        "Distance at which contacts are predicted.", contact.prediction_m),
    field!("contact.natural_frequency_hz", Hertz, (0.1, 1e6), Log, Nudge::Share(0.25),
        "Stiffness of contacts with the floor, as a natural frequency; contacts between modules have half of it.", contact.natural_frequency_hz),
    field!("contact.damping_ratio", One, (0.0, 1000.0), Log, Nudge::Share(0.25),
        "Damping ratio of contacts; with the natural frequency it decides how fast penetration is pushed out.", contact.damping_ratio),
    choice!("contact.friction_model", MODELS,
        "0: Simplified, a friction pyramid per contact area (Rapier); 1: Coulomb, a cone at every contact point; 2: Relaxed, a convex cone as MuJoCo's (tree solver).",
        contact.friction_model),
    choice!("contact.on", ON,
        "0: nothing touches the robot, which has to be held, and runs are faster; 1: contacts with the floor, the scene and itself.", contact.is_on),
];

/// Whether there are contacts, in the order of their numbers.
const ON: [bool; 2] = [false, true];

/// Friction models in the order of their numbers.
const MODELS: [FrictionModel; 3] = [
    FrictionModel::Simplified,
    FrictionModel::Coulomb,
    FrictionModel::Relaxed,
];
