//! The doubt about a joint that is counted in the other direction than its command or its speed.

use super::Seen;
use super::obedience::{DELAY_S, Obedience, slope_over_speed};
use super::series::measured;

/// With the other sign, less than this share of the error remains, …
const CLEARER: f64 = 0.3;
/// … and less than this share of the variance of the command.
const EXPLAINED: f64 = 0.5;
/// Half a period of delay looks like a turned sign: with the sign as read, delays up to this, seconds, …
const LONG_DELAY_S: f64 = 0.6;
/// … must leave more than `EXPLAINED`, of which the other sign leaves less than this share.
const CLEARER_THAN_LATE: f64 = 0.6;
/// The smallest correlation, without its sign, of changes of the angle with the recorded speed, …
const CORRELATED: f64 = 0.75;
/// … and the range of their slopes.
const ALIKE: std::ops::Range<f64> = 0.5..2.0;

/// A message about joints that move against their commands or their speeds.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    against_command(seen).or_else(|| against_speed(seen))
}

fn against_command(seen: &Seen<'_>) -> Option<String> {
    let all = Obedience::of(seen)?;
    let found = all.joints.iter().filter_map(|(angle, command)| {
        let variance = all.variance(command)?;
        let turned = all.misfit(angle, command, -1.0, DELAY_S);
        if turned >= EXPLAINED * variance {
            return None;
        }
        let as_read = all.misfit(angle, command, 1.0, DELAY_S);
        let late = all.misfit(angle, command, 1.0, LONG_DELAY_S);
        let is_late = late <= EXPLAINED * variance || turned >= CLEARER_THAN_LATE * late;
        let is_clear = turned < CLEARER * as_read && !is_late;
        is_clear.then(|| (format!("`{}`", angle.name), turned / as_read))
    });
    let (names, shares): (Vec<String>, Vec<f64>) = found.unzip();
    let share = shares.into_iter().reduce(f64::max)?;
    Some(format!(
        "{} moves against its command: with the other sign, {:.0} % of the error remains; change the sign of its angles or of its commands",
        names.join(", "),
        100.0 * share
    ))
}

fn against_speed(seen: &Seen<'_>) -> Option<String> {
    let times_s = seen.trajectory.times_s();
    let is_turned = |joint: &&crate::trajectory::JointTrack| {
        let found = slope_over_speed(times_s, joint);
        found.is_some_and(|(slope, correlation)| {
            correlation < -CORRELATED && ALIKE.contains(&-slope)
        })
    };
    let names = measured(seen.trajectory).filter(is_turned);
    let names: Vec<String> = names.map(|joint| format!("`{}`", joint.name)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{} moves against its recorded speed: change the sign of its angles or of its speeds",
            names.join(", ")
        )
    })
}
