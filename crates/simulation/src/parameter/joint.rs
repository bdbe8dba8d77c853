//! Parameters of joint encoders.

use super::member::{adjust, shared};
use super::{Nudge, Parameter, entry};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    entry!("joint.zero_rad", Radian, (-3.2, 3.2), Linear, Nudge::Absolute(0.01),
        "Reading of the encoder of every joint at angle 0; servos, recorded starts and recorded samples use encoder angles.",
        |e, of| shared(e, of, |_, change| Some(change.zero_rad)).or(Some(0.0)),
        |e, of, value| adjust(e, of, |change| change.zero_rad = value)),
];
