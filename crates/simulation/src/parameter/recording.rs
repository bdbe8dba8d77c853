//! Parameters of errors of the recordings, as opposed to the robot.

use super::{Nudge, Parameter, field};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("recording.length_scale", One, (0.01, 100.0), Log, Nudge::Share(0.01),
        "Recorded lengths are this times the true ones; recordings are divided by it before they are used.",
        recording_length_scale),
];
