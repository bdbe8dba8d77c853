//! The doubt about commands that sit at their largest or smallest value most of the time.

use super::Seen;
use super::series::quantile;
use crate::trajectory::{COMMAND, Trajectory};
use realgap_core::statistics::ends_of;

/// The share of samples at the ends from which commands are doubted.
const MOST: f64 = 0.5;
/// Commands are at an end within this share of their range.
const ROUNDING: f64 = 1e-6;
/// The smallest number of arrivals at an end; fewer are those of a motion that goes to a place and waits there.
const ARRIVALS: usize = 4;
/// A clipped command arrives at its end in motion: its last step is longer than this share of a usual step between the ends, …
const IN_MOTION: f64 = 0.5;
/// … in more than this share of its arrivals.
const USUALLY: f64 = 0.5;
/// The smallest number of samples between the ends: a command of two values alone is a square wave, which nobody clipped.
const BETWEEN: usize = 20;
/// The endings of signals that are commands.
const SIGNALS: [&str; 2] = ["_command_nm", "_command_rad_s"];

/// A message about commands that are cut off at their ends in most samples.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let found = commands(seen.trajectory).filter_map(|(name, values)| Some((name, share(values)?)));
    let found: Vec<(&str, f64)> = found.collect();
    let most = found.iter().map(|(_, share)| *share).reduce(f64::max)?;
    let names: Vec<String> = found.iter().map(|(name, _)| format!("`{name}`")).collect();
    Some(format!(
        "{} is at its largest or its smallest value in {:.0} % of the samples, and runs into these ends at full speed: the commands saturate, and a robot that always pushes as hard as it may says little about its gains; record again with smaller motions, or crop to a part in which the commands move",
        names.join(", "),
        100.0 * most
    ))
}

/// The commands of a recording, with the names of their columns.
fn commands(trajectory: &Trajectory) -> impl Iterator<Item = (&str, &[f64])> {
    let joints = trajectory.joints().iter();
    let angles = joints.filter(|joint| joint.name.ends_with(COMMAND));
    let signals = trajectory.signals().iter();
    let is_command = |name: &str| SIGNALS.iter().any(|ending| name.ends_with(ending));
    let signals = signals.filter(move |signal| is_command(&signal.name));
    angles
        .map(|joint| (&*joint.name, &*joint.angles_rad))
        .chain(signals.map(|signal| (&*signal.name, &*signal.values)))
}

/// The share of samples at the ends, if the values are cut off there.
fn share(values: &[f64]) -> Option<f64> {
    let (low, high) = ends_of(values.iter().copied());
    let near = ROUNDING * (high - low);
    let is_end = |value: f64| value <= low + near || value >= high - near;
    let at_ends = values.iter().filter(|value| is_end(**value)).count();
    let between = values.len() - at_ends;
    let share = at_ends as f64 / values.len() as f64;
    if near == 0.0 || share < MOST || between < BETWEEN {
        return None;
    }
    let steps = || values.windows(2).map(|w| (w[1] - w[0]).abs());
    let inside = |w: &[f64]| !is_end(w[0]) && !is_end(w[1]);
    let moves = values
        .windows(2)
        .zip(steps())
        .filter(|(w, step)| inside(w) && *step > 0.0);
    let usual = quantile(moves.map(|(_, step)| step).collect(), 0.5)?;
    // The last whole step before an end; the one that reaches it is cut off.
    let arrivals = values
        .windows(3)
        .filter(|w| !is_end(w[0]) && !is_end(w[1]) && is_end(w[2]));
    let (mut all, mut in_motion) = (0_usize, 0_usize);
    for arrival in arrivals {
        all += 1;
        in_motion += usize::from((arrival[1] - arrival[0]).abs() > IN_MOTION * usual);
    }
    (all >= ARRIVALS && in_motion as f64 > USUALLY * all as f64).then_some(share)
}
