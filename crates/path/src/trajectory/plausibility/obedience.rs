//! How well measured angles follow commands: the evidence for columns that are exchanged, turned round or in other units.

use crate::trajectory::{JointTrack, clock};

use super::Seen;

/// The largest delay of a servo, seconds.
pub(super) const DELAY_S: f64 = 0.25;
/// The number of delays that are tried.
const DELAYS: usize = 9;
/// The largest number of samples that are compared, evenly spread.
const SAMPLES: usize = 2000;
/// The smallest number of samples from which something follows.
const ENOUGH: usize = 40;
/// The largest number of joints that are compared with each other.
const JOINTS: usize = 64;
/// The smallest variance of a command from which something follows, radians².
const STILL_RAD2: f64 = 1e-6;

/// The joints with commands that move, and which samples of them are compared.
pub(super) struct Obedience<'a> {
    pub joints: Vec<(&'a JointTrack, &'a JointTrack)>,
    samples: usize,
    interval_s: f64,
}

/// The sums of an angle and a delayed command over samples.
struct Moments {
    angle: f64,
    command: f64,
    product: f64,
}

impl<'a> Obedience<'a> {
    pub fn of(seen: &Seen<'a>) -> Option<Self> {
        let mut joints = clock::commanded_joints(seen.trajectory);
        joints.truncate(JOINTS);
        let samples = seen.trajectory.len();
        (samples >= ENOUGH && !joints.is_empty()).then_some(Self {
            joints,
            samples,
            interval_s: seen.interval_s,
        })
    }

    /// Variances of the angle and of the command that was given `delay` samples before, and their covariance.
    fn moments(&self, angle: &JointTrack, command: &JointTrack, delay: usize) -> Moments {
        let every = self.samples.div_ceil(SAMPLES);
        let pairs = || {
            (delay..self.samples)
                .step_by(every)
                .map(|k| (angle.angles_rad[k], command.angles_rad[k - delay]))
        };
        let count = pairs().count() as f64;
        let (a, c) = pairs().fold((0.0, 0.0), |(a, c), pair| (a + pair.0, c + pair.1));
        let (a, c) = (a / count, c / count);
        let mut moments = Moments {
            angle: 0.0,
            command: 0.0,
            product: 0.0,
        };
        for (angle, command) in pairs() {
            moments.angle += (angle - a).powi(2) / count;
            moments.command += (command - c).powi(2) / count;
            moments.product += (angle - a) * (command - c) / count;
        }
        moments
    }

    /// The delays that are tried, in samples.
    fn delays(&self, longest_s: f64) -> impl Iterator<Item = usize> {
        let longest = ((longest_s / self.interval_s) as usize).min(self.samples / 4);
        let mut all: Vec<usize> = (0..DELAYS).map(|k| k * longest / (DELAYS - 1)).collect();
        all.dedup();
        all.into_iter()
    }

    /// The variance of the command; `None` if it does not move.
    pub fn variance(&self, command: &JointTrack) -> Option<f64> {
        let variance = self.moments(command, command, 0).command;
        (variance > STILL_RAD2).then_some(variance)
    }

    /// The remaining variance of the angle minus `sign` times the command, after the delay up to `longest_s` that fits best. A constant
    /// difference does not count, because encoders have zeros of their own.
    pub fn misfit(
        &self,
        angle: &JointTrack,
        command: &JointTrack,
        sign: f64,
        longest_s: f64,
    ) -> f64 {
        let of = |delay: usize| {
            let moments = self.moments(angle, command, delay);
            moments.angle + moments.command - 2.0 * sign * moments.product
        };
        self.delays(longest_s).map(of).fold(f64::INFINITY, f64::min)
    }

    /// The slope of the angle over the command and their correlation, after the delay with the largest correlation.
    pub fn slope(&self, angle: &JointTrack, command: &JointTrack) -> Option<(f64, f64)> {
        let of = |delay: usize| {
            let moments = self.moments(angle, command, delay);
            let size = (moments.angle * moments.command).sqrt();
            (size > 0.0).then(|| (moments.product / moments.command, moments.product / size))
        };
        let all = self.delays(DELAY_S).filter_map(of);
        all.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

/// The largest number of parts into which a recording is cut.
const PARTS: usize = 200;
/// The smallest number of parts from which something follows.
const FEW: usize = 12;

/// The slope of the change of an angle over the integral of its recorded speed, and their correlation, over short parts of the recording.
pub(super) fn slope_over_speed(times_s: &[f64], joint: &JointTrack) -> Option<(f64, f64)> {
    let speeds = joint.speeds_rad_s.as_deref()?;
    let long = (times_s.len() - 1).div_ceil(PARTS);
    let (mut xx, mut xy, mut yy, mut parts) = (0.0, 0.0, 0.0, 0);
    for from in (0..times_s.len() - 1).step_by(long) {
        let to = (from + long).min(times_s.len() - 1);
        let step = |k: usize| 0.5 * (speeds[k] + speeds[k + 1]) * (times_s[k + 1] - times_s[k]);
        let x: f64 = (from..to).map(step).sum();
        let y = joint.angles_rad[to] - joint.angles_rad[from];
        xx += x * x;
        xy += x * y;
        yy += y * y;
        parts += 1;
    }
    let size = (xx * yy).sqrt();
    (parts >= FEW && size > 0.0).then(|| (xy / xx, xy / size))
}
