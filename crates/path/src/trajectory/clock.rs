//! Checks whether joint commands and joint angles were stamped by the same clock.

use super::{COMMAND, JointTrack, Trajectory};
use realgap_core::statistics::{mean, standard_deviation};

/// The largest delay that is tested, in both directions, seconds.
const REACH_S: f64 = 0.6;
/// The smallest variance of a joint's command from which a delay can be estimated, radians².
const STILL_RAD2: f64 = 1e-4;
/// A delay is significant if it leaves less than this share of the error that another delay leaves.
const CLEARER: f64 = 0.7;
/// In addition, the errors must differ by this share of the command's variance: on a ramp, a delay is only an offset and cannot be
/// estimated.
const PLAINER: f64 = 0.05;
/// The number of samples by which angles may precede their command without a warning.
const EARLY: usize = 2;
/// The largest change of the delay over a recording that a servo can cause, seconds.
const DRIFT_S: f64 = 0.15;
/// The smallest number of samples from which a delay is estimated.
const ENOUGH: usize = 60;
/// The largest number of samples that are compared for one delay; of longer recordings, evenly spread samples are compared.
const COMPARED: usize = 5000;
/// The largest number of delays in one direction that are tried at first; then those near the best one.
const COARSE: i64 = 50;

/// A joint and its commanded angles.
type CommandedJoint<'a> = (&'a JointTrack, &'a JointTrack);

/// The joints whose commanded angles were recorded too.
pub(super) fn commanded_joints(trajectory: &Trajectory) -> Vec<CommandedJoint<'_>> {
    let command = |joint: &JointTrack| trajectory.joint(&format!("{}{COMMAND}", joint.name));
    let joints = trajectory.joints().iter();
    joints
        .filter_map(|joint| Some((joint, command(joint)?)))
        .collect()
}

/// A message if angles and commands have different clocks: the angles precede the commands, or the delay changes over the recording.
pub(super) fn clock_fault(trajectory: &Trajectory, interval_s: f64) -> Option<String> {
    let joints = commanded_joints(trajectory);
    let all = 0..trajectory.len();
    let reach = ((REACH_S / interval_s) as usize).min(trajectory.len() / 8) as i64;
    if joints.is_empty() || reach < 2 || all.len() < ENOUGH {
        return None;
    }
    let (lag, error) = best_delay(&joints, all.clone(), reach)?;
    if lag < -(EARLY as i64) && is_smaller_error(error, remaining_error(&joints, all, 0)?) {
        return Some(format!(
            "angles move {:.3} s before their commands: the clocks differ, and a fit mistakes this for a delay; stamp both with one clock, or add this time to the times of the angles",
            -lag as f64 * interval_s
        ));
    }
    let third = trajectory.len() / 3;
    if third < ENOUGH {
        return None;
    }
    let (first, last) = (0..third, trajectory.len() - third..trajectory.len());
    let (early, at_first) = best_delay(&joints, first.clone(), reach)?;
    let (late, at_last) = best_delay(&joints, last.clone(), reach)?;
    let drift_s = (late - early) as f64 * interval_s;
    let is_significant = is_smaller_error(at_first, remaining_error(&joints, first, late)?)
        && is_smaller_error(at_last, remaining_error(&joints, last, early)?);
    (drift_s.abs() > DRIFT_S && is_significant).then(|| {
        format!(
            "angles follow their commands after {:.3} s in the first third and after {:.3} s in the last: one of two clocks is faster; stamp both with one clock, or crop to a part",
            early as f64 * interval_s,
            late as f64 * interval_s
        )
    })
}

fn is_smaller_error(error: f64, other: f64) -> bool {
    error < CLEARER * other && error + PLAINER < other
}

/// The delay, in samples, that fits the angles best to their commands, and its remaining error.
fn best_delay(
    joints: &[CommandedJoint<'_>],
    samples: std::ops::Range<usize>,
    reach: i64,
) -> Option<(i64, f64)> {
    let best = |delays: &mut dyn Iterator<Item = i64>| {
        let errors =
            delays.filter_map(|lag| Some((lag, remaining_error(joints, samples.clone(), lag)?)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let step = (reach + COARSE - 1) / COARSE;
    let coarse = best(&mut (-reach..=reach).step_by(step as usize))?;
    if step == 1 {
        return Some(coarse);
    }
    best(&mut ((coarse.0 - step).max(-reach)..=(coarse.0 + step).min(reach)))
}

/// The remaining error of a delay: the mean over joints of the variance of angle minus delayed command, divided by the variance of the command.
/// Offsets do not count.
fn remaining_error(
    joints: &[CommandedJoint<'_>],
    samples: std::ops::Range<usize>,
    lag: i64,
) -> Option<f64> {
    let shares = joints.iter().filter_map(|(angle, command)| {
        let (angles, commands) = (&angle.angles_rad, &command.angles_rad);
        let every = samples.len().div_ceil(COMPARED).max(1);
        let compared = || samples.clone().step_by(every);
        let told: Vec<f64> = compared().map(|k| commands[k]).collect();
        let spread = standard_deviation(&told).powi(2);
        let differences: Vec<f64> = compared()
            .filter_map(|k| Some(angles[k] - commands.get(usize::try_from(k as i64 - lag).ok()?)?))
            .collect();
        (spread > STILL_RAD2).then(|| standard_deviation(&differences).powi(2) / spread)
    });
    let shares: Vec<f64> = shares.collect();
    (!shares.is_empty()).then(|| mean(&shares))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A joint that follows a command after a delay of `late_s` seconds, which grows by `drift` seconds per second.
    fn followed(late_s: f64, drift: f64) -> Trajectory {
        let times_s: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let command = |t: f64| (1.0 * t).sin() + 0.5 * (2.7 * t).sin();
        let track = |name: &str, angle: &dyn Fn(f64) -> f64| JointTrack {
            name: name.to_owned(),
            angles_rad: times_s.iter().map(|t| angle(*t)).collect(),
            speeds_rad_s: None,
        };
        let joints = vec![
            track("elbow", &|t| 0.9 * command(t - late_s - drift * t) + 0.05),
            track("elbow_command", &command),
        ];
        Trajectory::new(times_s.clone(), vec![Vector3::zeros(); 1000])
            .and_then(|path| path.with_joints(joints))
            .unwrap()
    }

    #[test]
    fn different_clocks_are_reported_and_the_delay_of_a_servo_is_not() {
        for (late_s, drift, expected) in [
            (0.0, 0.0, None),
            (0.12, 0.0, None),
            (0.3, 0.0, None),
            (-0.2, 0.0, Some("0.200 s before")),
            (0.05, 0.015, Some("in the last")),
            (0.3, -0.02, Some("in the last")),
        ] {
            let fault = clock_fault(&followed(late_s, drift), 0.02);
            match expected {
                None => assert_eq!(fault, None, "{late_s} s, {drift}"),
                Some(words) => assert!(
                    fault.as_deref().is_some_and(|fault| fault.contains(words)),
                    "{late_s} s, {drift}: {fault:?}"
                ),
            }
        }
    }
}
