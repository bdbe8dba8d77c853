//! Checks a recording for common faults, and warns with a remedy: wrong units, gaps in time, a standstill at the start, another order of
//! quaternions.

use nalgebra::{UnitQuaternion, Vector3};

use super::reading::{QuaternionOrder, Reading};
use super::{Trajectory, clock};
use realgap_core::unit::TimeUnit;
use realgap_core::warning::{Code, Warning};

/// The largest plausible interval between samples, seconds.
const SLOW_S: f64 = 2.0;
/// The smallest plausible interval between samples, seconds.
const FAST_S: f64 = 1e-5;
/// Plausible sampling rates of a tracker, Hz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.5..=5000.0;
/// The longest interval without a sample, in usual intervals, that is interpolated without a warning.
const HOLE: f64 = 5.5;
/// A standstill is reported if it is longer than this, seconds, …
const WAIT_S: f64 = 1.0;
/// … and longer than this share of the recording.
const WAIT_SHARE: f64 = 0.05;
/// During a standstill, the distance from the start is below this share of the largest distance.
const WAIT_DISTANCE: f64 = 0.02;
/// During a standstill, the robot has turned by less than this, radians.
const WAIT_TURN_RAD: f64 = 0.05;
/// During a standstill, the speed is below this share of the usual later speed.
const WAIT_SPEED: f64 = 0.1;
/// Speeds are computed over windows of this length, seconds, because of the tracker's noise between single samples.
const WAIT_WINDOW_S: f64 = 0.5;
/// The smallest share of windows within a standstill that must be slow.
const WAIT_WINDOWS: f64 = 0.8;
/// The share of samples that may repeat the previous joint angles although the commands change, because joints may stick.
const STALE: f64 = 0.1;
/// The largest tilt, radians, in the other order of quaternions, if that is the right order.
const UPRIGHT_RAD: f64 = 0.175;
/// The smallest tilt, radians, in the order as read, that casts doubt on this order.
const TILTED_RAD: f64 = 0.524;

/// Warnings about faults of this recording, whose quaternions were read in the order `read_as`.
pub(super) fn warnings(
    name: &str,
    trajectory: &Trajectory,
    reading: &Reading,
    read_as: QuaternionOrder,
) -> Vec<Warning> {
    // Times in messages count from the start of the whole recording, also if it was cropped.
    let cropped_s = reading.crop.map_or(0.0, |crop| crop.from_s);
    let origin_s = trajectory.times_s()[0] - cropped_s;
    let found = [
        time(trajectory).map(|message| (Code::UnlikelyTime, message)),
        hole(trajectory, origin_s).map(|message| (Code::Hole, message)),
        wait(trajectory, origin_s).map(|message| (Code::Standstill, message)),
        order(trajectory, read_as).map(|message| (Code::QuaternionOrder, message)),
        stale(trajectory).map(|message| (Code::StaleSamples, message)),
        clock::clock_fault(trajectory, usual_interval_s(trajectory))
            .map(|message| (Code::UnsynchronisedClocks, message)),
    ];
    let found = found.into_iter().flatten();
    found
        .map(|(code, message)| code.warning(format!("{name}: {message}")))
        .collect()
}

/// A message about samples that repeat all joint angles of the previous sample although their commands have changed.
fn stale(trajectory: &Trajectory) -> Option<String> {
    let joints = clock::commanded_joints(trajectory);
    let differs = |angles: &[f64], k: usize| angles[k] != angles[k - 1];
    let has_new_command = |k: &usize| joints.iter().any(|(_, c)| differs(&c.angles_rad, *k));
    let repeats = |k: &usize| !joints.iter().any(|(j, _)| differs(&j.angles_rad, *k));
    let moved: Vec<usize> = (1..trajectory.len()).filter(has_new_command).collect();
    let repeated = moved.iter().filter(|k| repeats(k)).count();
    let share = repeated as f64 / moved.len().max(1) as f64;
    (share > STALE).then(|| {
        format!(
            "{:.0} % of the samples whose commands differ from the previous sample repeat all its angles: they were read too late, and are compared unchanged",
            100.0 * share
        )
    })
}

/// The usual time between samples, seconds.
pub(super) fn usual_interval_s(trajectory: &Trajectory) -> f64 {
    let times_s = trajectory.times_s();
    let mut intervals_s: Vec<f64> = times_s.windows(2).map(|w| w[1] - w[0]).collect();
    intervals_s.sort_by(f64::total_cmp);
    intervals_s[intervals_s.len() / 2]
}

/// A message about times that are probably not in seconds.
fn time(trajectory: &Trajectory) -> Option<String> {
    let usual_s = usual_interval_s(trajectory);
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
fn hole(trajectory: &Trajectory, origin_s: f64) -> Option<String> {
    let times_s = trajectory.times_s();
    if times_s.len() < 4 {
        return None;
    }
    let usual_s = usual_interval_s(trajectory);
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

/// A message about a recording that begins before the robot moves.
fn wait(trajectory: &Trajectory, origin_s: f64) -> Option<String> {
    let until_s = waits_until_s(trajectory)?;
    Some(format!(
        "nothing moves for the first {:.2} s, but a simulation starts to move at once: `crop: (from_s: {:.2})` leaves the standstill out",
        until_s - trajectory.times_s()[0],
        until_s - origin_s
    ))
}

/// The time at which a standstill at the start ends; `None` if there is no long standstill.
pub(super) fn waits_until_s(trajectory: &Trajectory) -> Option<f64> {
    let positions = trajectory.positions_world_m();
    let times_s = trajectory.times_s();
    let distance = |position: &Vector3<f64>| (position - positions[0]).norm();
    let farthest = positions.iter().map(distance).fold(0.0, f64::max);
    let turned = |index: usize| {
        let all = trajectory.orientations_world_from_body();
        all.map_or(0.0, |all| all[index].angle_to(&all[0]))
    };
    let start = (0..positions.len()).find(|index| {
        distance(&positions[*index]) > WAIT_DISTANCE * farthest || turned(*index) > WAIT_TURN_RAD
    })?;
    let window = (WAIT_WINDOW_S / usual_interval_s(trajectory)).ceil() as usize;
    let speeds_m_s: Vec<f64> = (window..positions.len())
        .map(|end| {
            let from = end - window;
            (positions[end] - positions[from]).norm() / (times_s[end] - times_s[from])
        })
        .collect();
    let mut later_m_s = speeds_m_s.get(start..)?.to_vec();
    later_m_s.sort_by(f64::total_cmp);
    let later_m_s = later_m_s.get(later_m_s.len() / 2)?;
    let is_slow = |speed_m_s: &f64| *speed_m_s < WAIT_SPEED * later_m_s;
    let early = speeds_m_s.get(..start.checked_sub(window)?)?;
    let last_slow = early.iter().rposition(is_slow)?;
    let slow = early[..=last_slow].iter().filter(|s| is_slow(s)).count();
    let end = last_slow + window;
    let waited_s = times_s[end] - times_s[0];
    let is_long = waited_s > WAIT_S && waited_s > WAIT_SHARE * trajectory.duration_s();
    (is_long && slow as f64 > WAIT_WINDOWS * (1 + last_slow) as f64).then(|| times_s[end])
}

/// A message if the other order of quaternions keeps the robot upright, but the order as read does not.
fn order(trajectory: &Trajectory, read_as: QuaternionOrder) -> Option<String> {
    let all = trajectory.orientations_world_from_body()?;
    let tilt_rad = |q: UnitQuaternion<f64>| (q * Vector3::z()).z.clamp(-1.0, 1.0).acos();
    let most = |of: &dyn Fn(&UnitQuaternion<f64>) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let as_read = most(&|q| tilt_rad(*q));
    if as_read < TILTED_RAD {
        return None;
    }
    let parts = |w, i, j, k| {
        tilt_rad(UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(
            w, i, j, k,
        )))
    };
    let (other, order) = match read_as {
        QuaternionOrder::Wxyz => (most(&|q| parts(q.k, q.w, q.i, q.j)), QuaternionOrder::Xyzw),
        QuaternionOrder::Xyzw => (most(&|q| parts(q.i, q.j, q.k, q.w)), QuaternionOrder::Wxyz),
    };
    (other < UPRIGHT_RAD).then(|| {
        format!(
            "the robot tilts by up to {:.0} deg as its quaternions are read; as `quaternion: \"{}\"` it stays upright within {:.0} deg",
            as_read.to_degrees(),
            order.name(),
            other.to_degrees()
        )
    })
}
