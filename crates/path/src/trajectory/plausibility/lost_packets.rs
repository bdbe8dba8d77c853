//! The doubt about packets that were lost between robot and recorder: rows that are missing, or samples that repeat the last packet.

use std::ops::Range;

use super::series::{Steps, measured, runs};
use super::{Seen, and_more};
use crate::trajectory::JointTrack;

/// An interval longer than this many usual ones lacks a row.
const LACKS: f64 = 1.6;
/// Intervals are whole multiples of the usual one within this share of it.
const WHOLE: f64 = 0.25;
/// Of all intervals, at least this share must be whole multiples: those of a computer without a fixed rate are not.
const MOST_WHOLE: f64 = 0.9;
/// The share of rows that may be missing without a doubt, …
const FEW: f64 = 0.01;
/// … and the smallest number of places that is doubted.
const FEWEST: usize = 5;
/// Losses are spread over more than this share of the recording: a computer that is slow at its start loses no packets.
const SPREAD: f64 = 0.3;

/// Packets are lost where all joints repeat for at least this many samples, …
const HELD: usize = 3;
/// … and a joint then jumps by more than this many large steps of its own, and of its steps afterwards: a joint that starts by itself gains
/// speed.
const JUMP: f64 = 2.0;
/// The number of these steps afterwards.
const AFTER: usize = 3;
/// A message about lost packets of a recording of joints.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let is_of_joints = measured(seen.trajectory).next().is_some();
    is_of_joints.then(|| missing(seen).or_else(|| held(seen)))?
}

fn missing(seen: &Seen<'_>) -> Option<String> {
    let times_s = seen.trajectory.times_s();
    let intervals = || times_s.windows(2).map(|w| (w[1] - w[0]) / seen.interval_s);
    let is_whole = |n: &f64| *n > 0.5 && (n - n.round()).abs() < WHOLE;
    let whole = intervals().filter(is_whole).count();
    if (whole as f64) < MOST_WHOLE * (times_s.len() - 1) as f64 {
        return None;
    }
    let lacking: Vec<(usize, f64)> = intervals()
        .enumerate()
        .filter(|(_, n)| *n > LACKS)
        .collect();
    let lost: usize = lacking.iter().map(|(_, n)| n.round() as usize - 1).sum();
    let share = lost as f64 / (times_s.len() + lost) as f64;
    let [first, last] = [lacking.first()?.0, lacking.last()?.0];
    let is_spread = (last - first) as f64 > SPREAD * times_s.len() as f64;
    if lacking.len() < FEWEST || share < FEW || !is_spread {
        return None;
    }
    let (longest, n) = lacking.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "{:.0} % of the rows are missing, in {} places, the longest from {} on ({:.0} rows): packets were lost; angles are interpolated there and commands held, so record again over a better link, or crop to a part without losses",
        100.0 * share,
        lacking.len(),
        seen.at(*longest),
        n.round() - 1.0
    ))
}

fn held(seen: &Seen<'_>) -> Option<String> {
    let trajectory = seen.trajectory;
    let joints: Vec<&JointTrack> = measured(trajectory).collect();
    let count = trajectory.len();
    let repeats = |k: usize| {
        k > 0
            && joints
                .iter()
                .all(|joint| joint.angles_rad[k] == joint.angles_rad[k - 1])
    };
    let steps: Vec<Steps> = joints
        .iter()
        .map(|joint| Steps::of(joint.angles_rad.as_slice()))
        .collect();
    let jumps = |to: usize| {
        steps.iter().any(|own| {
            let after = &own.lengths[to..(to + AFTER).min(own.lengths.len())];
            let next = after.iter().copied().fold(0.0, f64::max);
            own.fast > 0.0 && own.lengths[to - 1] > JUMP * own.fast.max(next)
        })
    };
    let all = runs(count, repeats);
    let is_lost = |run: &Range<usize>| run.len() >= HELD && run.end < count && jumps(run.end);
    let lost: Vec<Range<usize>> = all.into_iter().filter(is_lost).collect();
    let longest = lost.iter().max_by_key(|run| run.len())?;
    Some(format!(
        "all joints repeat their angles exactly from {} to {} ({} samples), and then jump{}: packets were lost; leave these rows out, or record again over a better link",
        seen.at(longest.start - 1),
        seen.at(longest.end - 1),
        longest.len(),
        and_more(lost.len())
    ))
}
