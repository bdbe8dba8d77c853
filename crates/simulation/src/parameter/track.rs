//! Parameters of where on the robot its recorded motion was measured.

use super::{Nudge, Parameter, field};

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    field!("track.forward_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "How far the markers that were recorded are ahead of the tracked point of the robot's file.", adjustment.track_offset_m.x),
    field!("track.left_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "How far the markers that were recorded are to the left of the tracked point of the robot's file.", adjustment.track_offset_m.y),
    field!("track.up_m", Metre, (-10.0, 10.0), Linear, Nudge::Absolute(0.001),
        "How far the markers that were recorded are above the tracked point of the robot's file.", adjustment.track_offset_m.z),
    field!("track.heading_rad", Radian, (-3.2, 3.2), Linear, Nudge::Absolute(0.01),
        "How far the heading that was recorded is turned to the left against the robot's own.", adjustment.track_heading_rad),
];
