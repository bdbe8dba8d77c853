//! Angles of headings and beams.

/// The angle that differs by whole turns and lies in (−π, π].
pub(super) fn wrapped(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turn = angle_rad.rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}
