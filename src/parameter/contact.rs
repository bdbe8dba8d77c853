//! The contact model of the solver.

use super::Parameter;
use crate::quantity::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[Parameter {
    name: "contact.prediction_m",
    unit: Unit::Metre,
    bounds: (0.0, 0.1),
    whole: false,
    doc: "Distance at which contacts are predicted.",
    get: |e| Some(e.contact.prediction_m),
    set: |e, value| e.contact.prediction_m = value,
}];
