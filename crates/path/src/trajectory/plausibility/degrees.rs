//! The doubt about angles in degrees that were read as radians, although they are small enough to pass for radians.

use super::Seen;
use super::obedience::{Obedience, slope_over_speed};
use super::series::{measured, quantile};
use crate::trajectory::{JointTrack, Trajectory};
use realgap_core::statistics::ends_of;
use realgap_core::unit::number;

/// The ratios of an angle in degrees to its command in radians: 57.3, or less where a weak servo does not get as far as it is told, …
const OVER_COMMAND: std::ops::Range<f64> = 20.0..80.0;
/// … and of a command in degrees to its angle in radians, for the same reason.
const UNDER_COMMAND: std::ops::Range<f64> = 40.0..160.0;
/// The ratios of the change of an angle to the integral of its speed, or the other way round, if one of them is in degrees.
const OVER_SPEED: std::ops::Range<f64> = 40.0..80.0;
/// The ratio of two columns in the same unit.
const ALIKE: std::ops::Range<f64> = 0.2..2.5;
/// The smallest correlation from which a ratio follows.
const CORRELATED: f64 = 0.75;
/// The smallest step of an encoder, as a number, that is too coarse for radians: 126 steps a turn.
const COARSE: f64 = 0.05;
/// A step is a multiple of the smallest one within this share of it.
const MULTIPLE: f64 = 0.02;
/// The share of steps that must be multiples.
const MOST: f64 = 0.98;
/// The smallest number of steps, and of different angles, from which a resolution follows.
const ENOUGH: [usize; 2] = [20, 5];
/// The largest number of steps that are looked at.
const LOOKED_AT: usize = 20_000;
/// A joint that never makes a full turn does not turn as fast as this half of the time, rad/s.
const FAST_RAD_S: f64 = 25.0;
/// Speeds are means over this time, seconds, because of the steps of encoders.
const SPEED_S: f64 = 0.02;

/// How a column relates to another of the same joint.
enum Unit {
    Same,
    AngleInDegrees,
    OtherInDegrees,
}

/// The relation that a slope of the angle over another column shows, if it shows one.
fn unit(
    (slope, correlation): (f64, f64),
    over: &std::ops::Range<f64>,
    under: &std::ops::Range<f64>,
) -> Option<Unit> {
    let slope = slope.abs();
    match correlation.abs() > CORRELATED {
        true if over.contains(&slope) => Some(Unit::AngleInDegrees),
        true if under.contains(&(1.0 / slope)) => Some(Unit::OtherInDegrees),
        true if ALIKE.contains(&slope) => Some(Unit::Same),
        _ => None,
    }
}

/// A message about the first joint whose angles, commands or speeds are probably degrees.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let trajectory = seen.trajectory;
    let obedience = Obedience::of(seen);
    measured(trajectory).find_map(|joint| {
        let told = obedience.as_ref().and_then(|all| {
            let (angle, command) = all.joints.iter().find(|(angle, _)| angle.name == joint.name)?;
            all.variance(command)?;
            all.slope(angle, command)
        });
        let others = [
            ("commands", told, [&OVER_COMMAND, &UNDER_COMMAND]),
            (
                "speeds",
                slope_over_speed(trajectory.times_s(), joint),
                [&OVER_SPEED, &OVER_SPEED],
            ),
        ];
        let name = &joint.name;
        let mut is_known = false;
        for (other, slope, [over, under]) in others {
            let Some(slope) = slope else { continue };
            let ratio = number(slope.0.abs().max(1.0 / slope.0.abs()));
            match unit(slope, over, under) {
                Some(Unit::AngleInDegrees) => {
                    return Some(format!(
                        "`{name}` moves {ratio} times as far as its {other} say: its angles are probably degrees read as radians; name the column {name}_deg"
                    ));
                }
                Some(Unit::OtherInDegrees) => {
                    return Some(format!(
                        "the {other} of `{name}` are {ratio} times as large as its motion: they are probably degrees read as radians; name their column with `_deg`"
                    ));
                }
                Some(Unit::Same) => is_known = true,
                None => {}
            }
        }
        if is_known {
            return None;
        }
        coarse(joint).or_else(|| hasty(trajectory, joint))
    })
}

/// A message about angles in steps that are too coarse for radians.
fn coarse(joint: &JointTrack) -> Option<String> {
    let angles = &joint.angles_rad[..joint.angles_rad.len().min(LOOKED_AT)];
    let steps = angles.windows(2).map(|w| (w[1] - w[0]).abs());
    let steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |step: &&f64| (*step / least - (*step / least).round()).abs() < MULTIPLE;
    let multiples = steps.iter().filter(is_multiple).count();
    let mut levels: Vec<i64> = angles
        .iter()
        .map(|angle| (angle / least).round() as i64)
        .collect();
    levels.sort_unstable();
    levels.dedup();
    let is_coarse = least >= COARSE
        && steps.len() >= ENOUGH[0]
        && levels.len() >= ENOUGH[1]
        && multiples as f64 >= MOST * steps.len() as f64;
    is_coarse.then(|| {
        let name = &joint.name;
        format!(
            "`{name}` comes in steps of {} rad, but an encoder is finer: its angles are probably degrees read as radians; name the column {name}_deg",
            number(least)
        )
    })
}

/// A message about a joint that stays within one turn, but is faster than a joint can go there and back.
fn hasty(trajectory: &Trajectory, joint: &JointTrack) -> Option<String> {
    let (times_s, angles) = (trajectory.times_s(), &joint.angles_rad);
    let (low, high) = ends_of(angles.iter().copied());
    let mut speeds = Vec::new();
    let mut from = 0;
    for to in 1..times_s.len() {
        let lasts_s = times_s[to] - times_s[from];
        if lasts_s >= SPEED_S {
            speeds.push((angles[to] - angles[from]).abs() / lasts_s);
            from = to;
        }
    }
    if high - low > std::f64::consts::TAU || speeds.len() < ENOUGH[0] {
        return None;
    }
    let usual = quantile(speeds, 0.5)?;
    (usual > FAST_RAD_S).then(|| {
        let name = &joint.name;
        format!(
            "`{name}` turns at over {} rad/s half of the time and never makes a full turn: its angles are probably degrees read as radians; name the column {name}_deg",
            number(usual)
        )
    })
}
