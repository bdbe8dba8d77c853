//! The doubt about a part of a recording in another unit of length than the rest.

use std::ops::Range;

use super::Seen;
use super::series::{Series as _, quantile};
use nalgebra::Vector3;
use realgap_core::unit::number;

/// The ratios of units of length, and their names.
const RATIOS: [(f64, &str); 2] = [
    (1000.0, "metres and millimetres"),
    (100.0, "metres and centimetres"),
];
/// The number of samples on each side that say how large steps are there.
const AROUND: usize = 10;
/// The path continues in the other unit: within this many steps.
const NEAR: f64 = 5.0;
/// The path jumps by more than this many steps of the part with the larger numbers.
const JUMP: f64 = 2.0;
/// Farther from the origin than this many steps, the jump itself shows the ratio.
const FAR: f64 = 20.0;
/// Nearer to the origin, the size of the steps must change by the ratio within this factor, …
const SIMILAR: f64 = 5.0;
/// … and consecutive steps of the part with the smaller numbers must not oppose each other by more than this share (-1 to 1): those of the
/// noise of a robot that rests before it starts do, by a half.
const OPPOSED: f64 = -0.25;
/// The number of samples from which this share is computed.
const LONG: usize = 40;
/// The smallest number of samples before and behind the change.
const FEWEST: usize = 5;

/// A message about the first sample from which on all coordinates are multiplied or divided by 1000 or 100.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let positions = seen.trajectory.positions_world_m();
    let last = positions.len().checked_sub(FEWEST)?;
    let (sample, ratio, units, grows) = (FEWEST..=last).find_map(|sample| {
        RATIOS.iter().find_map(|(ratio, units)| {
            let grows = [true, false]
                .into_iter()
                .find(|grows| changes(positions, sample, *ratio, *grows))?;
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
    let [before_m, after_m] = [positions[sample - 1], positions[sample]];
    let [small_m, large_m] = if grows {
        [before_m, after_m]
    } else {
        [after_m, before_m]
    };
    // This test is cheap and nearly always ends the search here.
    if large_m.norm() <= FAR * small_m.norm() {
        return false;
    }
    let before = (sample - 1).saturating_sub(AROUND)..sample - 1;
    let after = sample..(sample + AROUND).min(positions.len() - 1);
    // All in the unit of the smaller numbers.
    let [small, large] = if grows {
        [before, after]
    } else {
        [after, before]
    };
    let step = |range: &Range<usize>| {
        let lengths = range
            .clone()
            .map(|k| positions.distance(k, k + 1))
            .collect();
        quantile(lengths, 0.5).unwrap_or(0.0)
    };
    let [step_m, large_step_m] = [step(&small), step(&large)];
    let usual = step_m.max(large_step_m / ratio);
    let continues = (large_m / ratio - small_m).norm() <= NEAR * usual;
    let jumps = (large_m - small_m).norm() > JUMP * ratio * usual;
    if !(continues && jumps) {
        return false;
    }
    let grown = large_step_m / step_m / ratio;
    let is_rescaled = grown.is_finite() && (1.0 / SIMILAR..SIMILAR).contains(&grown);
    let from = small
        .start
        .saturating_sub(if grows { LONG - AROUND } else { 0 });
    let to = (small.end + if grows { 0 } else { LONG - AROUND }).min(positions.len() - 1);
    small_m.norm() > FAR * usual || (is_rescaled && agreement(&positions[from..=to]) > OPPOSED)
}

/// How far consecutive steps point in one direction, from -1 to 1.
fn agreement(positions: &[Vector3<f64>]) -> f64 {
    let steps: Vec<Vector3<f64>> = positions.windows(2).map(|w| w[1] - w[0]).collect();
    let products: f64 = steps.windows(2).map(|w| w[0].dot(&w[1])).sum();
    let squares: f64 = steps.iter().map(Vector3::norm_squared).sum();
    if squares > 0.0 {
        products / squares
    } else {
        0.0
    }
}
