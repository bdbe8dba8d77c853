//! The doubt about joints that stop following their commands for a while, and then follow again.

use std::ops::Range;

use super::Seen;
use super::obedience::Obedience;
use super::series::quantile;
use realgap_core::statistics::{ends_of, mean, standard_deviation};
use realgap_core::unit::number;

/// A joint stands still while its angle stays within this share of its range.
const STILL: f64 = 0.02;
/// The smallest range of an angle, radians, from which something follows.
const SMALLEST_RAD: f64 = 0.02;
/// A servo may stick or be late for this time, seconds.
const LATE_S: f64 = 0.3;
/// While the joint stands still, its command moves by more than this share of the joint's range, …
const MOVES: f64 = 0.4;
/// … where commands beyond the joint's own range do not count, because a stop may hold it. The rest of the recording is followed: the
/// error has less than this share of the command's variance, …
const FOLLOWED: f64 = 0.5;
/// … and the error becomes this many times as large as nearly all errors elsewhere: a joint that sticks has large errors everywhere.
const FARTHER: f64 = 3.0;
/// Elsewhere the command goes up and down by this share of its way here or more: a joint that sticks only shows it after it has turned round.
const TURNS: f64 = 0.5;
/// Or the joint comes back to its command within [`LATE_S`], and moves this many times as far in this time as it nearly always does.
const BACK: f64 = 3.0;
/// This share of the errors is nearly all of them.
const NEARLY_ALL: f64 = 0.98;
/// The number of delays that are tried.
const DELAYS: usize = 8;
/// The largest part of a recording in which a joint may be switched off; beyond it, the commands are those of something else.
const LARGEST: f64 = 0.7;

/// A message about the longest time in which joints stand still although their commands move.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let all = Obedience::of(seen)?;
    let times_s = seen.trajectory.times_s();
    let found = all.joints.iter().filter_map(|(angle, command)| {
        let still = longest_off(times_s, &angle.angles_rad, &command.angles_rad)?;
        Some((&angle.name, still))
    });
    let found: Vec<(&String, Range<usize>)> = found.collect();
    let lasts_s = |samples: &Range<usize>| times_s[samples.end - 1] - times_s[samples.start];
    let (_, longest) = found
        .iter()
        .max_by(|a, b| lasts_s(&a.1).total_cmp(&lasts_s(&b.1)))?;
    let names: Vec<String> = found.iter().map(|(name, _)| format!("`{name}`")).collect();
    let [from_s, to_s] = [longest.start, longest.end - 1].map(|k| times_s[k] - seen.origin_s);
    let remedy = match longest.start < seen.trajectory.len() - longest.end {
        true => format!("`crop: (from_s: {to_s:.3})` begins after it"),
        false => format!("`crop: (to_s: {from_s:.3})` ends before it"),
    };
    Some(format!(
        "{} stands still for {} s from {} on while its command moves, and follows it elsewhere: was the robot switched off? A column `{}_on` of 0 and 1 says when a servo is on; {remedy}",
        names.join(", "),
        number(lasts_s(longest)),
        seen.at(longest.start),
        found[0].0
    ))
}

/// The longest samples in which the angle stands still and the command moves within the joint's range.
fn longest_off(times_s: &[f64], angles: &[f64], commands: &[f64]) -> Option<Range<usize>> {
    let count = angles.len();
    let (low, high) = ends_of(angles.iter().copied());
    let size = high - low;
    if size < SMALLEST_RAD {
        return None;
    }
    let zero = angles.iter().zip(commands).map(|(a, c)| a - c).sum::<f64>() / count as f64;
    let told = |k: usize| (commands[k] + zero).clamp(low, high);
    let mut best: Option<Range<usize>> = None;
    let mut from = 0;
    while from < count {
        let (mut least, mut most, mut to) = (angles[from], angles[from], from + 1);
        while to < count {
            let [next_least, next_most] = [least.min(angles[to]), most.max(angles[to])];
            if next_most - next_least > STILL * size {
                break;
            }
            (least, most, to) = (next_least, next_most, to + 1);
        }
        let lasts_s = times_s[to - 1] - times_s[from];
        if lasts_s > 2.0 * LATE_S && (to - from) as f64 <= LARGEST * count as f64 {
            // Commands just before the end have no effect yet, so they do not count.
            let until = (from..to).take_while(|k| times_s[*k] < times_s[to - 1] - LATE_S);
            let (a, b) = ends_of(until.map(told));
            let is_longer = best.as_ref().is_none_or(|best| to - from > best.len());
            let is_asked = b - a > MOVES * size;
            if is_asked
                && is_longer
                && (turns_outside(commands, &(from..to), TURNS * (b - a))
                    || comes_back(times_s, angles, &(from..to)))
                && follows_outside(times_s, angles, commands, &(from..to))
            {
                best = Some(from..to);
            }
        }
        from = match lasts_s > LATE_S {
            true => to,
            // The next start is the next sample that is not within the range of this one.
            false => from + 1,
        };
    }
    best
}

/// Whether the command goes both up and down by this way outside of these samples.
fn turns_outside(commands: &[f64], off: &Range<usize>, way: f64) -> bool {
    let (mut up, mut down) = (0.0, 0.0);
    for part in [&commands[..off.start], &commands[off.end..]] {
        for step in part.windows(2).map(|w| w[1] - w[0]) {
            up += step.max(0.0);
            down -= step.min(0.0);
        }
    }
    up.min(down) > way
}

/// Whether the joint moves much faster behind these samples than elsewhere.
fn comes_back(times_s: &[f64], angles: &[f64], off: &Range<usize>) -> bool {
    let interval_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1) as f64;
    let reach = ((LATE_S / interval_s) as usize).max(1);
    let way = |k: usize| (angles[(k + reach).min(angles.len() - 1)] - angles[k]).abs();
    let elsewhere = (0..off.start.saturating_sub(reach)).chain(off.end + reach..angles.len());
    let usual = quantile(elsewhere.map(way).collect(), NEARLY_ALL);
    usual.is_some_and(|usual| off.end < angles.len() && way(off.end - 1) > BACK * usual)
}

/// Whether the angle follows its command outside of these samples, after the delay that fits best, and within them is farther from it than
/// there.
fn follows_outside(times_s: &[f64], angles: &[f64], commands: &[f64], off: &Range<usize>) -> bool {
    let interval_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1) as f64;
    let longest = (super::obedience::DELAY_S / interval_s) as usize;
    let every = (longest / DELAYS).max(1);
    // After a robot is switched on, it takes a while until it is where it is told.
    let back = off.end + (LATE_S / interval_s) as usize;
    let errors = |delay: usize, samples: &mut dyn Iterator<Item = usize>| -> Vec<f64> {
        samples
            .filter(|k| *k >= delay)
            .map(|k| angles[k] - commands[k - delay])
            .collect()
    };
    let outside = |delay: usize| errors(delay, &mut (0..off.start).chain(back..angles.len()));
    let told = |delay: usize| {
        let own = (0..off.start).chain(back..angles.len());
        own.filter(|k| *k >= delay)
            .map(|k| commands[k - delay])
            .collect::<Vec<f64>>()
    };
    let found = (0..=longest).step_by(every).filter_map(|delay| {
        let errors = outside(delay);
        let share = standard_deviation(&errors).powi(2) / standard_deviation(&told(delay)).powi(2);
        (errors.len() > 1 && share < FOLLOWED).then_some((share, delay))
    });
    let Some((_, delay)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return false;
    };
    let followed = outside(delay);
    let zero = mean(&followed);
    let size = |errors: Vec<f64>, share: f64| {
        quantile(
            errors.iter().map(|error| (error - zero).abs()).collect(),
            share,
        )
    };
    let largest = size(errors(delay, &mut off.clone()), NEARLY_ALL);
    let usual = size(followed, NEARLY_ALL);
    largest
        .zip(usual)
        .is_some_and(|(largest, usual)| largest > FARTHER * usual)
}
