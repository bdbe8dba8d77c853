//! The doubt about a part of a recording in another unit of length than the rest.

use super::Seen;
use super::series::{Series as _, quantile};
use nalgebra::Vector3;
use realgap_core::unit::number;

/// The ratios of units of length, and their names.
const RATIOS: [(f64, &str); 2] = [(1000.0, "metres and millimetres"), (100.0, "metres and centimetres")];
/// The number of samples on each side that say how large steps are there.
const AROUND: usize = 10;
/// The path continues in the other unit: within this many steps.
const NEAR: f64 = 5.0;
/// In one unit, the path jumps by more than this many steps of the larger numbers; a robot that starts at the origin does not.
const JUMP: f64 = 8.0;
/// Farther from the origin than this many steps, the jump itself shows the ratio.
const FAR: f64 = 20.0;
/// Near the origin, the size of the steps must change by the ratio within this factor.
const SIMILAR: f64 = 5.0;
/// The smallest number of samples before and behind the change.
const FEWEST: usize = 5;

/// A message about the first sample from which on all coordinates are multiplied or divided by 1000 or 100.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let positions = seen.trajectory.positions_world_m();
    let last = positions.len().checked_sub(FEWEST)?;
    let (sample, ratio, units, grows) = (FEWEST..=last).find_map(|sample| {
        RATIOS.iter().find_map(|(ratio, units)| {
            let grows = [true, false].into_iter().find(|grows| changes(positions, sample, *ratio, *grows))?;
            Some((sample, ratio, units, grows))
        })
    })?;
    let word = if grows { "larger" } else { "smaller" };
    Some(format!(
        "from {} on all coordinates are {} times {word}: {units} are mixed in one file; scale this part, or crop to one side of it",
        seen.at(sample),
        number(*ratio)
    ))
}

/// True if the path continues at `sample` in a unit that is `ratio` times smaller (the numbers grow) or larger.
fn changes(positions: &[Vector3<f64>], sample: usize, ratio: f64, grows: bool) -> bool {
    let factor = if grows { ratio } else { 1.0 / ratio };
    let [before_m, after_m] = [positions[sample - 1], positions[sample]];
    let [small_m, large_m] = if grows { [before_m, after_m] } else { [after_m, before_m] };
    // This test is cheap and nearly always ends the search here.
    if large_m.norm() <= FAR * small_m.norm() {
        return false;
    }
    let step = |range: std::ops::Range<usize>| {
        let lengths = range.map(|k| positions.distance(k, k + 1)).collect();
        quantile(lengths, 0.5).unwrap_or(0.0)
    };
    let before = step((sample - 1).saturating_sub(AROUND)..sample - 1);
    let after = step(sample..(sample + AROUND).min(positions.len() - 1));
    // All in the unit of the smaller numbers.
    let [small, large] = if grows { [before, after] } else { [after, before] };
    let usual = small.max(large / ratio);
    let continues = (large_m / ratio - small_m).norm() <= NEAR * usual;
    let jumps = (large_m - small_m).norm() > JUMP * ratio * usual;
    let is_far_from_origin = small_m.norm() > FAR * usual;
    let grown = after / before / factor;
    let is_rescaled = grown.is_finite() && (1.0 / SIMILAR..SIMILAR).contains(&grown);
    continues && jumps && (is_far_from_origin || is_rescaled)
}
