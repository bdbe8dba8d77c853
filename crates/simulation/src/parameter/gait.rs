//! Parameters of the gait, the open-loop command.

use super::{Nudge, Parameter, field};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("gait.frequency_scale", One, (0.0, 100.0), Log, Nudge::Share(0.02),
        "Factor on every gait frequency.", adjustment.frequency_scale),
    field!("gait.amplitude_scale", One, (0.0, 100.0), Linear, Nudge::Share(0.05),
        "Factor on every gait amplitude.", adjustment.amplitude_scale),
];
