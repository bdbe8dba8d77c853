//! What is wrong with the recordings rather than with the robot.

use super::{Nudge, Parameter, Scale};
use realgap_core::unit::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[Parameter {
    name: "recording.length_scale",
    unit: Unit::One,
    bounds: (0.01, 100.0),
    whole: false,
    scale: Scale::Log,
    nudge: Nudge::Share(0.01),
    doc: "Recorded lengths are this times the true ones; recordings are divided by it before they are used.",
    subject: "",
    get: |e, _| Some(e.recording_length_scale),
    set: |e, _, value| e.recording_length_scale = value,
}];
