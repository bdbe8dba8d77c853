//! Doubts about times: an unlikely interval between samples, and a gap without samples.

use super::Seen;
use realgap_core::unit::TimeUnit;

/// The largest plausible interval between samples, seconds.
const SLOW_S: f64 = 2.0;
/// The smallest plausible interval between samples, seconds.
const FAST_S: f64 = 1e-5;
/// Plausible sampling rates of a tracker, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.5..=5000.0;
/// The longest interval without a sample, in usual intervals, that is interpolated without a warning.
const HOLE: f64 = 5.5;

/// A message about times that are probably not in seconds.
pub(super) fn unlikely_interval(seen: &Seen<'_>) -> Option<String> {
    let usual_s = seen.interval_s;
    let interval = if usual_s > SLOW_S {
        format!("the interval between samples is {usual_s:.4} s")
    } else if usual_s < FAST_S {
        format!("the interval between samples is {usual_s:.1e} s")
    } else {
        return None;
    };
    let others: Vec<String> = TimeUnit::ALL
        .iter()
        .map(|unit| (unit, 1.0 / (usual_s * unit.seconds())))
        .filter(|(unit, rate_hz)| **unit != TimeUnit::Second && RATES_HZ.contains(rate_hz))
        .map(|(unit, rate_hz)| {
            let unit = unit.symbol();
            format!("`time: \"{unit}\"`, or `columns: (t: \"t_s in {unit}\")` where the name states seconds, makes it {rate_hz:.3} Hz")
        })
        .collect();
    Some(if others.is_empty() {
        format!("{interval}: is the unit of time right?")
    } else {
        format!("{interval}: {}", others.join(", "))
    })
}

/// A message about the longest gap without samples, which interpolation fills with a straight line.
pub(super) fn hole(seen: &Seen<'_>) -> Option<String> {
    let (times_s, origin_s) = (seen.trajectory.times_s(), seen.origin_s);
    if times_s.len() < 4 {
        return None;
    }
    let usual_s = seen.interval_s;
    let holes = || {
        let pairs = times_s.windows(2).enumerate();
        pairs.filter(|(_, w)| w[1] - w[0] > HOLE * usual_s)
    };
    let (at, longest) = holes().max_by(|(_, a), (_, b)| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    let [from_s, to_s] = [longest[0] - origin_s, longest[1] - origin_s];
    let more = match holes().count() - 1 {
        0 => String::new(),
        more => format!(" and {more} shorter"),
    };
    // The remedy keeps the longer part of the recording, before or after the gap.
    let is_late = longest[0] - times_s[0] >= times_s[times_s.len() - 1] - longest[1];
    let remedy = if is_late || at + 2 >= times_s.len() {
        format!("`crop: (to_s: {from_s:.3})` ends before it")
    } else {
        format!("`crop: (from_s: {to_s:.3})` begins after it")
    };
    Some(format!(
        "no sample from {from_s:.3} s to {to_s:.3} s ({:.0} usual intervals){more}; the path there is interpolated, {remedy}",
        (to_s - from_s) / usual_s
    ))
}
