//! The doubt about angles that jump by a full turn.

use std::f64::consts::TAU;

use super::series::{Steps, measured};
use super::{Seen, and_more};
use realgap_core::unit::number;

/// Full turns in radians, and in degrees that were read as radians.
const TURNS: [f64; 2] = [TAU, 360.0];
/// A jump is a full turn if it differs from one by at most this many large steps of the samples around it, …
const STEPS: f64 = 4.0;
/// … or by at most this share of a turn, …
const CLOSE: f64 = 0.02;
/// … but never by more than this share.
const NOT_CLOSE: f64 = 0.25;

/// A message about the joints whose measured angles jump by full turns.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let mut found = measured(seen.trajectory).filter_map(|joint| {
        let jumps = jumps(&joint.angles_rad);
        Some((joint, *jumps.first()?, jumps.len()))
    });
    let (joint, sample, count) = found.next()?;
    let others = match found.count() {
        0 => String::new(),
        many => format!("; so do {many} other joints"),
    };
    let by_rad = joint.angles_rad[sample + 1] - joint.angles_rad[sample];
    Some(format!(
        "`{}` jumps by {} rad, about a full turn, at {}{}{others}: its encoder counts within one turn, and the jump is taken for a motion; unwrap the angles before (e.g. `numpy.unwrap`)",
        joint.name,
        number(by_rad),
        seen.at(sample + 1),
        and_more(count)
    ))
}

/// The samples behind which the angle jumps by full turns.
pub(super) fn jumps(angles_rad: &[f64]) -> Vec<usize> {
    let steps = Steps::of(angles_rad);
    let is_jump = |sample: &usize| {
        let by = steps.lengths[*sample];
        by > 0.5 * TAU
            && TURNS.iter().any(|turn| {
                let turns = (by / turn).round();
                let usual = steps.around(&(sample + 1..sample + 1));
                let slack = (STEPS * usual).clamp(CLOSE * turn, NOT_CLOSE * turn);
                turns > 0.0 && (by - turns * turn).abs() <= slack && usual < NOT_CLOSE * turn
            })
    };
    (0..steps.lengths.len()).filter(is_jump).collect()
}
