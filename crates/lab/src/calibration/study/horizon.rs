//! Short horizons: a recording is cut into windows, and each run starts from the measured state at the beginning of a window, so
//! that an early error does not affect the rest.

use std::sync::Arc;

use serde::Deserialize;

use nalgebra::Vector3;
use realgap_core::statistics::mean;
use realgap_core::{Error, Result};
use realgap_path::trajectory::{JointTrack, Recording, Trajectory, cut_out};

/// Windows of one length that begin at equal intervals.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Horizon(f64, f64);

/// The speed at the start of a window is a mean over the first sample and so many samples on either side of it.
const AROUND: usize = 3;

impl Horizon {
    /// Length of a window, seconds.
    pub fn length_s(self) -> f64 {
        self.0
    }

    /// The windows of a recording, as recordings of their own that are named after the time at which they begin: half an interval
    /// after the recording begins, and every interval from then on. Joints start at measured angles, with the mean of seven
    /// measured speeds, or else with the slope of a line through seven angles. A path without velocities starts 0.05 s before its
    /// window, in the middle of the tenth of a second that is past when the window begins, with the slope of a line through the samples
    /// of that time: nothing of the window itself is used, and noise hardly matters.
    ///
    /// # Errors
    /// Times that are not positive numbers, or a recording that is too short for one window.
    pub(in crate::calibration) fn windows(self, recording: &Recording) -> Result<Vec<Recording>> {
        let Self(length_s, every_s) = self;
        let is_time = |s: f64| (1e-3..=3600.0).contains(&s);
        let motion = &recording.trajectory;
        let starts = (0..)
            .map(|k| (f64::from(k) + 0.5) * every_s)
            .take_while(|from_s| from_s + length_s <= motion.duration_s());
        let starts: Vec<f64> = if is_time(length_s) && is_time(every_s) {
            starts.collect()
        } else {
            Vec::new()
        };
        if starts.is_empty() {
            return Err(Error::invalid("no window of this recording")
                .at_file(&recording.path)
                .field("horizon")
                .found(format!("({length_s}, {every_s}) of {:.3} s", motion.duration_s()))
                .allowed("(length_s, every_s), so that the first window, half an interval late, ends within the recording"));
        }
        let log = Arc::new(motion.clone());
        let lead_s = match needs_velocity(motion) {
            true => 0.5 * PAST_S,
            false => 0.0,
        };
        let window = |from_s: f64| {
            let first = motion
                .times_s()
                .partition_point(|t| t - motion.times_s()[0] < from_s - lead_s - 1e-6);
            let part = cut_out(motion, first, length_s + lead_s)?;
            let joints = part.joints().to_vec();
            let joints = joints.into_iter().zip(motion.joints());
            let joints =
                joints.map(|(part, whole)| with_start_speed(part, whole, motion.times_s(), first));
            let part = part.clone().with_joints(joints.collect())?;
            Ok(Recording {
                name: format!("{}@{from_s}s", recording.name),
                trajectory: with_past_velocity(part, motion, first)?,
                log: Some(Arc::clone(&log)),
                bodies: Vec::new(),
                ..recording.clone()
            })
        };
        starts.into_iter().map(window).collect()
    }

    /// The name of the recording from which a window with this name was cut.
    pub(in crate::calibration) fn log_of(window: &str) -> &str {
        window.rsplit_once('@').map_or(window, |(log, _)| log)
    }

    /// When a window with this name begins, seconds after its recording.
    pub(in crate::calibration) fn begin_s(window: &str) -> Option<f64> {
        let (_, begin) = window.rsplit_once('@')?;
        begin.strip_suffix('s')?.parse().ok()
    }
}

/// The velocity with which the run of a window starts is that of this time before the window, seconds.
const PAST_S: f64 = 0.1;

/// Whether a path says how the body is turned, but not how fast it moves.
fn needs_velocity(motion: &Trajectory) -> bool {
    motion.orientations_world_from_body().is_some() && motion.velocities_world_m_s().is_none()
}

/// The samples within half of [`PAST_S`] of a sample; at least two.
fn around(times_s: &[f64], middle: usize) -> std::ops::Range<usize> {
    let reach_s = 0.5 * PAST_S + 1e-6;
    let from = times_s.partition_point(|t| *t < times_s[middle] - reach_s);
    let to = times_s.partition_point(|t| *t <= times_s[middle] + reach_s);
    // Two samples make a line.
    from.min(middle.saturating_sub(1))..to.max((middle + 1).min(times_s.len()))
}

/// The path of a window with velocities, the first of which is the slope of the samples around it; unchanged where velocities were
/// recorded, or where there are no orientations.
fn with_past_velocity(part: Trajectory, whole: &Trajectory, first: usize) -> Result<Trajectory> {
    let Some(turns) = whole
        .orientations_world_from_body()
        .filter(|_| needs_velocity(whole))
    else {
        return Ok(part);
    };
    let near = around(whole.times_s(), first);
    let times_s = &whole.times_s()[near.clone()];
    let turned = |k: usize| (turns[first].inverse() * turns[k]).scaled_axis();
    let linear = slope(times_s, near.clone().map(|k| whole.positions_world_m()[k]));
    let angular = slope(times_s, near.map(turned));
    let (mut linear_m_s, mut angular_rad_s) = (vec![linear], vec![angular]);
    let turns = part.orientations_world_from_body().unwrap_or_default();
    let steps = part
        .times_s()
        .windows(2)
        .zip(part.positions_world_m().windows(2));
    for ((times_s, places_m), turns) in steps.zip(turns.windows(2)) {
        let step_s = times_s[1] - times_s[0];
        linear_m_s.push((places_m[1] - places_m[0]) / step_s);
        angular_rad_s.push((turns[0].inverse() * turns[1]).scaled_axis() / step_s);
    }
    part.clone().with_velocities(linear_m_s, angular_rad_s)
}

/// The slope of the least-squares line through vectors over time.
fn slope(times_s: &[f64], vectors: impl Iterator<Item = Vector3<f64>>) -> Vector3<f64> {
    let middle_s = mean(times_s);
    let product = times_s.iter().zip(vectors);
    let product = product.fold(Vector3::zeros(), |sum, (t, v)| sum + v * (t - middle_s));
    product / squared_spread(times_s)
}

/// Sum of squared deviations from the mean.
fn squared_spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    values.iter().map(|value| (value - middle).powi(2)).sum()
}

/// Noise of the first velocity of a window over that of its positions or angles, 1/s.
pub(in crate::calibration) fn velocity_noise_1_s(times_s: &[f64]) -> f64 {
    // The samples before the first are as dense as those behind it.
    let behind = around(times_s, 0);
    let offsets_s: Vec<f64> = behind.map(|k| times_s[k] - times_s[0]).collect();
    let before = offsets_s.iter().skip(1).map(|t| -t);
    let all: Vec<f64> = before.chain(offsets_s.iter().copied()).collect();
    squared_spread(&all).sqrt().recip()
}

/// The joint of a window, with a start speed that measurement noise hardly affects.
fn with_start_speed(
    mut part: JointTrack,
    whole: &JointTrack,
    times_s: &[f64],
    first: usize,
) -> JointTrack {
    let near = first.saturating_sub(AROUND)..(first + AROUND + 1).min(times_s.len());
    let count = near.len() as f64;
    let speed_rad_s = match &whole.speeds_rad_s {
        Some(speeds) => speeds[near].iter().sum::<f64>() / count,
        None => {
            let (times_s, angles_rad) = (&times_s[near.clone()], &whole.angles_rad[near]);
            let middle_s = times_s.iter().sum::<f64>() / count;
            let square: f64 = times_s.iter().map(|t| (t - middle_s).powi(2)).sum();
            let product = times_s.iter().zip(angles_rad);
            product.map(|(t, a)| (t - middle_s) * a).sum::<f64>() / square
        }
    };
    let speeds = part
        .speeds_rad_s
        .get_or_insert_with(|| vec![0.0; part.angles_rad.len()]);
    speeds[0] = speed_rad_s;
    part
}
