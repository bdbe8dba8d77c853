//! The doubt about single samples far off the path: spikes of a position or of a joint.

use std::ops::Range;

use super::series::{Series, Steps, bend_around, measured};
use super::{Seen, and_more};
use realgap_core::unit::number;

/// The largest number of samples of one spike; a longer excursion may be a motion.
const LONGEST: usize = 5;
/// A spike is farther away than this many large bends of the path around it, …
const FAR: f64 = 6.0;
/// … than this many large steps around it, because a body that bounces also returns, …
const FAR_OF_STEPS: f64 = 3.0;
/// … and than this many large steps of the whole recording.
const FAR_OF_ALL: f64 = 3.0;
/// Behind a spike the path continues: not farther on than this many large steps for each sample.
const ONWARD: f64 = 1.5;
/// The smallest spike of a position, metres, that matters: a tracker that rests changes its last digit, too.
const SMALLEST_M: f64 = 1e-3;
/// The smallest spike of an angle, radians, that matters.
const SMALLEST_RAD: f64 = 0.02;
/// Spikes that are more frequent than this share of the samples are the noise or the motion of the recording.
const RARE: f64 = 0.05;

/// Samples far off the path before and behind them.
struct Spike {
    samples: Range<usize>,
    distance: f64,
}

/// A message about the farthest spike.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let trajectory = seen.trajectory;
    let of_path = spikes(trajectory.positions_world_m(), SMALLEST_M);
    if let Some((message, _)) = described(seen, &of_path, "the position", "m") {
        return Some(message);
    }
    let of_joints = measured(trajectory).filter_map(|joint| {
        let found = spikes(joint.angles_rad.as_slice(), SMALLEST_RAD);
        described(seen, &found, &format!("`{}`", joint.name), "rad")
    });
    let farthest = of_joints.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(farthest.0)
}

fn described(seen: &Seen<'_>, all: &[Spike], what: &str, unit: &str) -> Option<(String, f64)> {
    let worst = all
        .iter()
        .max_by(|a, b| a.distance.total_cmp(&b.distance))?;
    let samples = match worst.samples.len() {
        1 => "one sample".to_owned(),
        many => format!("{many} samples"),
    };
    let message = format!(
        "{what} leaves its path at {} for {samples} by {} {unit}, and returns{}: leave these rows out, or record again; a fit follows them",
        seen.at(worst.samples.start),
        number(worst.distance),
        and_more(all.len())
    );
    Some((message, worst.distance))
}

/// All spikes of a series that are at least `smallest` far away. Samples that are exactly 0 and turns of a wrapped angle are other faults.
fn spikes(series: &(impl Series + ?Sized), smallest: f64) -> Vec<Spike> {
    let (steps, count) = (Steps::of(series), series.count());
    let mut all: Vec<Spike> = Vec::new();
    let mut next = 0;
    for (before, length) in steps.lengths.iter().enumerate() {
        if before < next || *length <= FAR_OF_ALL * steps.fast.max(smallest / FAR_OF_ALL) {
            continue;
        }
        let found = (1..=LONGEST).find_map(|many| {
            let samples = before + 1..before + 1 + many;
            let behind = samples.end;
            if behind >= count {
                return None;
            }
            let usual = steps.around(&samples);
            let continues = series.distance(before, behind)
                <= ONWARD * (many + 1) as f64 * usual.max(steps.fast);
            let off = |sample: usize| {
                series
                    .distance(sample, before)
                    .min(series.distance(sample, behind))
            };
            let distance = samples.clone().map(off).fold(f64::INFINITY, f64::min);
            let is_far = distance > FAR_OF_STEPS * usual
                && distance > FAR * bend_around(series, &samples)
                && distance > FAR_OF_ALL * steps.fast;
            let is_zero = samples.clone().all(|sample| series.is_zero(sample));
            (continues && is_far && !is_zero).then_some(Spike { samples, distance })
        });
        if let Some(spike) = found {
            next = spike.samples.end;
            all.push(spike);
        }
    }
    let share = all.len() as f64 / count as f64;
    if share > RARE && all.len() > 1 {
        return Vec::new();
    }
    all
}
