//! Encoders of joints.

use super::member::{adjust, shared};
use super::{Nudge, Parameter, entry};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    entry!("joint.zero_rad", Radian, (-3.2, 3.2), Linear, Nudge::Absolute(0.01),
        "What the encoder of every joint reads at angle 0; servos, recorded starts and recorded samples go by the encoder.",
        |e, of| shared(e, of, |_, change| Some(change.zero_rad)).or(Some(0.0)),
        |e, of, value| adjust(e, of, |change| change.zero_rad = value)),
];
