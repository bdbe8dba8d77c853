//! What is unlikely about a recording, and what to do about it: other units, holes, waiting, another order of quaternions.

use nalgebra::{UnitQuaternion, Vector3};

use super::reading::{QuaternionOrder, Reading};
use super::{Trajectory, clock};
use realgap_core::unit::TimeUnit;
use realgap_core::warning::{Code, Warning};

/// Trackers take more than one sample in this time, seconds.
const SLOW_S: f64 = 2.0;
/// There is no more than one sample in this time, seconds.
const FAST_S: f64 = 1e-5;
/// Samples a second that a tracker may well take.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.5..=5000.0;
/// Longest time without a sample, in usual intervals, that is filled in silence.
const HOLE: f64 = 5.5;
/// Waiting is noticed where it is longer than this, seconds.
const WAIT_S: f64 = 1.0;
/// It is also longer than this share of the recording.
const WAIT_SHARE: f64 = 0.05;
/// Who waits has gone less than this share of the farthest distance from the start.
const WAIT_DISTANCE: f64 = 0.02;
/// Who waits has turned less than this, radians.
const WAIT_TURN_RAD: f64 = 0.05;
/// Who waits is slower than this share of its usual speed later on.
const WAIT_SPEED: f64 = 0.1;
/// A speed is one over this time, seconds: trackers tremble from sample to sample.
const WAIT_WINDOW_S: f64 = 0.5;
/// So many of the windows have to be that slow.
const WAIT_WINDOWS: f64 = 0.8;
/// So many samples may repeat the one before while commands move: joints may stick.
const STALE: f64 = 0.1;
/// A robot whose orientations lie in the other order stays upright within this, radians.
const UPRIGHT_RAD: f64 = 0.175;
/// It seems to tilt by more than this as they are read, radians.
const TILTED_RAD: f64 = 0.524;

/// What the reader of this recording should know; its quaternions were read in the order `read_as`.
pub(super) fn of(
    name: &str,
    trajectory: &Trajectory,
    reading: &Reading,
    read_as: QuaternionOrder,
) -> Vec<Warning> {
    // Parts are named from where the recording begins, whatever is left of it.
    let cropped_s = reading.crop.map_or(0.0, |crop| crop.from_s);
    let origin_s = trajectory.times_s()[0] - cropped_s;
    let found = [
        time(trajectory).map(|message| (Code::UnlikelyTime, message)),
        hole(trajectory, origin_s).map(|message| (Code::Hole, message)),
        wait(trajectory, origin_s).map(|message| (Code::Standstill, message)),
        order(trajectory, read_as).map(|message| (Code::QuaternionOrder, message)),
        stale(trajectory).map(|message| (Code::StaleSamples, message)),
        clock::doubt(trajectory, usual_interval_s(trajectory))
            .map(|message| (Code::UnsynchronisedClocks, message)),
    ];
    let found = found.into_iter().flatten();
    found
        .map(|(code, message)| code.warning(format!("{name}: {message}")))
        .collect()
}

/// Samples that repeat all joints of the one before although what these were told has changed.
fn stale(trajectory: &Trajectory) -> Option<String> {
    let joints = clock::told(trajectory);
    let differs = |angles: &[f64], k: usize| angles[k] != angles[k - 1];
    let is_told = |k: &usize| joints.iter().any(|(_, c)| differs(&c.angles_rad, *k));
    let repeats = |k: &usize| !joints.iter().any(|(j, _)| differs(&j.angles_rad, *k));
    let moved: Vec<usize> = (1..trajectory.len()).filter(is_told).collect();
    let repeated = moved.iter().filter(|k| repeats(k)).count();
    let share = repeated as f64 / moved.len().max(1) as f64;
    (share > STALE).then(|| {
        format!(
            "{:.0} % of the samples whose commands differ from the sample before repeat all its angles: they were read too late, and are compared as they are",
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

/// Times that are no seconds.
fn time(trajectory: &Trajectory) -> Option<String> {
    let usual_s = usual_interval_s(trajectory);
    let apart = if usual_s > SLOW_S {
        format!("samples are {usual_s:.4} s apart")
    } else if usual_s < FAST_S {
        format!("samples are {usual_s:.1e} s apart")
    } else {
        return None;
    };
    let others: Vec<String> = TimeUnit::ALL
        .iter()
        .map(|unit| (unit, 1.0 / (usual_s * unit.seconds())))
        .filter(|(unit, rate_hz)| **unit != TimeUnit::Second && RATES_HZ.contains(rate_hz))
        .map(|(unit, rate_hz)| format!("`time: \"{}\"` makes it {rate_hz:.3} Hz", unit.symbol()))
        .collect();
    Some(if others.is_empty() {
        format!("{apart}: is the unit of time right?")
    } else {
        format!("{apart}: {}", others.join(", "))
    })
}

/// A hole that interpolation would fill with a straight line.
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
    // Most of it is on the one side or on the other.
    let is_late = longest[0] - times_s[0] >= times_s[times_s.len() - 1] - longest[1];
    let remedy = if is_late || at + 2 >= times_s.len() {
        format!("`crop: (to_s: {from_s:.3})` ends before it")
    } else {
        format!("`crop: (from_s: {to_s:.3})` begins after it")
    };
    Some(format!(
        "no sample from {from_s:.3} s to {to_s:.3} s ({:.0} usual intervals){more}; what lies there is interpolated, {remedy}",
        (to_s - from_s) / usual_s
    ))
}

/// A recording that begins before the robot does.
fn wait(trajectory: &Trajectory, origin_s: f64) -> Option<String> {
    let until_s = waits_until_s(trajectory)?;
    Some(format!(
        "nothing moves for the first {:.2} s, a simulation starts at once: `crop: (from_s: {:.2})` leaves the waiting out",
        until_s - trajectory.times_s()[0],
        until_s - origin_s
    ))
}

/// Until when nothing moves, where that is long.
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

/// Orientations of an upright robot whose real part stands at the other end.
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
