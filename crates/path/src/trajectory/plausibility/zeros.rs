//! Doubts about zeros that stand for lost samples: positions at the origin and joints that drop to 0.

use std::ops::Range;

use super::series::{Series, Steps, measured, runs};
use super::{Seen, and_more};
use realgap_core::unit::number;

/// Zeros are doubted if the path jumps to or from them by more than this many large steps of the samples around them, …
const FAR: f64 = 6.0;
/// … and by more than this many large steps of the whole recording.
const FAR_OF_ALL: f64 = 3.0;
/// The smallest jump of an angle, radians, that matters.
const SMALLEST_RAD: f64 = 0.02;
/// A jump elsewhere counts as alike if it is at least this share as long: a path that jumps anyway also jumps to 0.
const ALIKE: f64 = 0.5;

/// Samples that are exactly 0, with the longer one of the jumps to and from them.
struct Dropout {
    samples: Range<usize>,
    jump: f64,
}

/// A message about positions that are exactly 0 although the path before or behind them is elsewhere.
pub(super) fn of_positions(seen: &Seen<'_>) -> Option<String> {
    let all = dropouts(seen.trajectory.positions_world_m(), 0.0);
    let worst = all.iter().max_by(|a, b| a.jump.total_cmp(&b.jump))?;
    Some(format!(
        "the position is exactly 0 from {} to {} ({} samples), {} m from the path beside it{}: zeros stand for lost samples; leave these rows out, or write nothing in their place",
        seen.at(worst.samples.start),
        seen.at(worst.samples.end - 1),
        worst.samples.len(),
        number(worst.jump),
        and_more(all.len())
    ))
}

/// A message about a joint that drops to exactly 0 and returns.
pub(super) fn of_joints(seen: &Seen<'_>) -> Option<String> {
    let found = measured(seen.trajectory).filter_map(|joint| {
        let all = dropouts(joint.angles_rad.as_slice(), SMALLEST_RAD);
        let worst = all.into_iter().max_by(|a, b| a.jump.total_cmp(&b.jump))?;
        Some((joint, worst))
    });
    let found: Vec<_> = found.collect();
    let (joint, worst) = found.iter().max_by(|a, b| a.1.jump.total_cmp(&b.1.jump))?;
    Some(format!(
        "`{}` drops to exactly 0 from {} to {} ({} samples), {} rad from its angles beside them{}: the joint was not read there; leave these rows out",
        joint.name,
        seen.at(worst.samples.start),
        seen.at(worst.samples.end - 1),
        worst.samples.len(),
        number(worst.jump),
        match found.len() {
            1 => String::new(),
            many => format!(" (and {} other joints)", many - 1),
        }
    ))
}

fn dropouts(series: &(impl Series + ?Sized), smallest: f64) -> Vec<Dropout> {
    let count = series.count();
    let zeros = runs(count, |sample| series.is_zero(sample));
    if zeros.is_empty() {
        return Vec::new();
    }
    let steps = Steps::of(series);
    let jumps = |samples: &Range<usize>| {
        let into = samples
            .start
            .checked_sub(1)
            .map(|before| steps.lengths[before]);
        [into, steps.lengths.get(samples.end - 1).copied()]
    };
    let dropout = |samples: Range<usize>| {
        let jump = jumps(&samples).into_iter().flatten().fold(0.0, f64::max);
        let is_far =
            jump > FAR * steps.around(&samples) && jump > FAR_OF_ALL * typical(series, &steps);
        (is_far && jump > smallest).then_some(Dropout { samples, jump })
    };
    let all: Vec<Dropout> = zeros.into_iter().filter_map(dropout).collect();
    let Some(least) = all.iter().map(|one| one.jump).min_by(f64::total_cmp) else {
        return all;
    };
    let is_elsewhere = |k: &usize| !series.is_zero(*k) && !series.is_zero(k + 1);
    let elsewhere = (0..steps.lengths.len()).filter(is_elsewhere);
    let alike = elsewhere
        .filter(|k| steps.lengths[*k] > ALIKE * least)
        .count();
    if alike > 2 * all.len() {
        Vec::new()
    } else {
        all
    }
}

/// A large step between samples of which none is 0; zeros that are frequent must not make their own jumps usual.
fn typical(series: &(impl Series + ?Sized), steps: &Steps) -> f64 {
    let own = |k: &usize| !series.is_zero(*k) && !series.is_zero(k + 1) && steps.lengths[*k] > 0.0;
    let lengths = (0..steps.lengths.len())
        .filter(own)
        .map(|k| steps.lengths[k]);
    super::series::quantile(lengths.collect(), 0.9).unwrap_or(0.0)
}
