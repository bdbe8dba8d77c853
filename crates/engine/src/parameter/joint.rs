//! Encoders of joints.

use super::member::{adjust, shared};
use super::{Nudge, Parameter, Scale};
use realgap_core::unit::Unit;

pub(super) static PARAMETERS: &[Parameter] = &[Parameter {
    name: "joint.zero_rad",
    unit: Unit::Radian,
    bounds: (-3.2, 3.2),
    whole: false,
    scale: Scale::Linear,
    nudge: Nudge::Absolute(0.01),
    doc: "What the encoder of every joint reads at angle 0; servos, recorded starts and recorded samples go by the encoder.",
    subject: "",
    get: |e, of| shared(e, of, |_, change| Some(change.zero_rad)).or(Some(0.0)),
    set: |e, of, value| adjust(e, of, |change| change.zero_rad = value),
}];
