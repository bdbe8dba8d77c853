//! The doubt about a recording that begins before the robot moves.

use nalgebra::Vector3;

use super::{Seen, usual_interval_s};
use crate::trajectory::Trajectory;

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

/// A message about a recording that begins before the robot moves.
pub(super) fn doubt(seen: &Seen<'_>) -> Option<String> {
    let until_s = waits_until_s(seen.trajectory)?;
    Some(format!(
        "nothing moves for the first {:.2} s, but a simulation starts to move at once: `crop: (from_s: {:.2})` leaves the standstill out",
        until_s - seen.trajectory.times_s()[0],
        until_s - seen.origin_s
    ))
}

/// The time at which a standstill at the start ends; `None` if there is no long standstill.
pub(in crate::trajectory) fn waits_until_s(trajectory: &Trajectory) -> Option<f64> {
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
