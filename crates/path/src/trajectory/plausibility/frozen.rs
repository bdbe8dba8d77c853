//! The doubt about a tracker that repeats one pose for a while, although the robot moves on.

use std::ops::Range;

use super::series::{Series as _, Steps, quantile};
use super::{Seen, and_more};
use realgap_core::unit::number;

/// The smallest number of samples that repeat a pose.
const FEWEST: usize = 5;
/// Where poses are held as a rule, a frozen one is held this many times as long.
const LONGER: f64 = 4.0;
/// Behind the frozen samples the path jumps by more than this many large steps of the samples around them, …
const JUMP: f64 = 3.0;
/// … and by more than this many large steps of the whole recording.
const JUMP_OF_ALL: f64 = 1.5;

/// A message about the longest stretch with one pose that ends with a jump. A robot that rests starts again with usual steps, and one that
/// rests until the end of the recording does not start again.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let positions = seen.trajectory.positions_world_m();
    let turns = seen.trajectory.orientations_world_from_body();
    let repeats =
        |k: usize| positions[k] == positions[k - 1] && turns.is_none_or(|all| all[k] == all[k - 1]);
    // The runs of samples with one pose, the first of them included.
    let mut held: Vec<Range<usize>> = Vec::new();
    for sample in 0..positions.len() {
        match held.last_mut() {
            Some(last) if sample > 0 && repeats(sample) => last.end = sample + 1,
            _ => held.push(sample..sample + 1),
        }
    }
    let usual = quantile(held.iter().map(|run| run.len() as f64).collect(), 0.9)?;
    let least = (FEWEST + 1).max((LONGER * usual).ceil() as usize);
    let steps = Steps::of(positions);
    let jump_m = |run: &Range<usize>| {
        (run.end < positions.len()).then(|| positions.distance(run.end - 1, run.end))
    };
    let is_frozen = |run: &&Range<usize>| {
        let is_inside = run.start > 0 && run.len() >= least;
        let is_zero = positions.is_zero(run.start);
        is_inside
            && !is_zero
            && jump_m(run).is_some_and(|jump_m| {
                jump_m > JUMP * moving_around(&steps, run) && jump_m > JUMP_OF_ALL * steps.fast
            })
    };
    let frozen: Vec<&Range<usize>> = held.iter().filter(is_frozen).collect();
    let longest = frozen.iter().max_by_key(|run| run.len())?;
    Some(format!(
        "the pose repeats exactly from {} to {} ({} samples) and then jumps by {} m{}: the tracker was frozen while the robot moved; leave these rows out, or crop to one side of them",
        seen.at(longest.start),
        seen.at(longest.end - 1),
        longest.len(),
        number(jump_m(longest)?),
        and_more(frozen.len())
    ))
}

/// A large step around a run, where poses that are held do not count as steps.
fn moving_around(steps: &Steps, run: &Range<usize>) -> f64 {
    const REACH: usize = 40;
    let before = steps.lengths[..run.start].iter().rev().take(REACH);
    let after = steps.lengths[run.end.min(steps.lengths.len())..]
        .iter()
        .take(REACH);
    let some = |lengths: &mut dyn Iterator<Item = &f64>| -> Vec<f64> {
        lengths
            .copied()
            .filter(|length| *length > 0.0)
            .take(12)
            .collect()
    };
    let mut all = some(&mut before.into_iter());
    all.extend(some(&mut after.into_iter()));
    all.sort_by(|a, b| b.total_cmp(a));
    all.get(1).or(all.first()).copied().unwrap_or(f64::INFINITY)
}
