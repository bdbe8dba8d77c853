//! Short horizons: a recording is cut into windows, and each run starts from the measured state at the beginning of a window, so
//! that an early error does not affect the rest.

use serde::Deserialize;

use realgap_core::{Error, Result};
use realgap_path::trajectory::{JointTrack, Recording, cut_out};

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
    /// measured speeds, or else with the slope of a line through seven angles.
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
        let window = |from_s: f64| {
            let first = motion
                .times_s()
                .partition_point(|t| t - motion.times_s()[0] < from_s - 1e-6);
            let part = cut_out(motion, first, length_s)?;
            let joints = part.joints().to_vec();
            let joints = joints.into_iter().zip(motion.joints());
            let joints =
                joints.map(|(part, whole)| with_start_speed(part, whole, motion.times_s(), first));
            Ok(Recording {
                name: format!("{}@{from_s}s", recording.name),
                trajectory: part.clone().with_joints(joints.collect())?,
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
