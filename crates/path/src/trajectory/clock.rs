//! Whether what joints were told and what they did were stamped by clocks that agree.

use super::{COMMAND, JointTrack, Trajectory};
use realgap_core::statistics::{mean, standard_deviation};

/// Delays that are looked at, seconds either way.
const REACH_S: f64 = 0.6;
/// Joints whose commands vary by less than this tell no delay, radians².
const STILL_RAD2: f64 = 1e-4;
/// A delay is told where it leaves less than this share of what another one leaves.
const CLEARER: f64 = 0.7;
/// It leaves less by more than this share of the command's variance, too: on a ramp a delay is an offset, and tells nothing.
const PLAINER: f64 = 0.05;
/// Samples by which an effect may seem to come before its cause.
const EARLY: usize = 2;
/// A delay that changes by more than this over the recording is no servo's, seconds.
const DRIFT_S: f64 = 0.15;
/// Samples of a third of the recording that can tell a delay.
const ENOUGH: usize = 60;

/// A joint with what it was told.
type Told<'a> = (&'a JointTrack, &'a JointTrack);

/// Joints whose commanded angles were recorded, too.
pub(super) fn told(trajectory: &Trajectory) -> Vec<Told<'_>> {
    let command = |joint: &JointTrack| trajectory.joint(&format!("{}{COMMAND}", joint.name));
    let joints = trajectory.joints().iter();
    joints
        .filter_map(|joint| Some((joint, command(joint)?)))
        .collect()
}

/// What is wrong with the clocks of angles and commands: angles that lead, or a delay that grows.
pub(super) fn doubt(trajectory: &Trajectory, interval_s: f64) -> Option<String> {
    let joints = told(trajectory);
    let all = 0..trajectory.len();
    let reach = ((REACH_S / interval_s) as usize).min(trajectory.len() / 8) as i64;
    if joints.is_empty() || reach < 2 || all.len() < ENOUGH {
        return None;
    }
    let (lag, error) = best(&joints, all.clone(), reach)?;
    if lag < -(EARLY as i64) && is_clearer(error, left(&joints, all, 0)?) {
        return Some(format!(
            "angles move {:.3} s before what they are told: clocks differ, and what is fitted takes it for a delay; stamp both by one clock, or add as much to the times of the angles",
            -lag as f64 * interval_s
        ));
    }
    let third = trajectory.len() / 3;
    if third < ENOUGH {
        return None;
    }
    let (first, last) = (0..third, trajectory.len() - third..trajectory.len());
    let (early, at_first) = best(&joints, first.clone(), reach)?;
    let (late, at_last) = best(&joints, last.clone(), reach)?;
    let drift_s = (late - early) as f64 * interval_s;
    let is_told = is_clearer(at_first, left(&joints, first, late)?)
        && is_clearer(at_last, left(&joints, last, early)?);
    (drift_s.abs() > DRIFT_S && is_told).then(|| {
        format!(
            "angles come {:.3} s after what they are told in the first third and {:.3} s in the last: one of two clocks is faster; stamp both by one clock, or crop to a part",
            early as f64 * interval_s,
            late as f64 * interval_s
        )
    })
}

fn is_clearer(error: f64, other: f64) -> bool {
    error < CLEARER * other && error + PLAINER < other
}

/// The delay, in samples, after which angles are most like their commands, and what it leaves.
fn best(joints: &[Told<'_>], samples: std::ops::Range<usize>, reach: i64) -> Option<(i64, f64)> {
    let errors =
        (-reach..=reach).filter_map(|lag| Some((lag, left(joints, samples.clone(), lag)?)));
    errors.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Mean over joints of the variance of angle minus delayed command, as a share of the command's: offsets do not count.
fn left(joints: &[Told<'_>], samples: std::ops::Range<usize>, lag: i64) -> Option<f64> {
    let shares = joints.iter().filter_map(|(angle, command)| {
        let (angles, commands) = (&angle.angles_rad, &command.angles_rad);
        let spread = standard_deviation(&commands[samples.clone()]).powi(2);
        let apart: Vec<f64> = (samples.clone())
            .filter_map(|k| Some(angles[k] - commands.get(usize::try_from(k as i64 - lag).ok()?)?))
            .collect();
        (spread > STILL_RAD2).then(|| standard_deviation(&apart).powi(2) / spread)
    });
    let shares: Vec<f64> = shares.collect();
    (!shares.is_empty()).then(|| mean(&shares))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A joint that follows a chirp late by so many seconds, which change by a share of the time.
    fn followed(late_s: f64, drift: f64) -> Trajectory {
        let times_s: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let told = |t: f64| (1.0 * t).sin() + 0.5 * (2.7 * t).sin();
        let track = |name: &str, angle: &dyn Fn(f64) -> f64| JointTrack {
            name: name.to_owned(),
            angles_rad: times_s.iter().map(|t| angle(*t)).collect(),
            speeds_rad_s: None,
        };
        let joints = vec![
            track("elbow", &|t| 0.9 * told(t - late_s - drift * t) + 0.05),
            track("elbow_command", &told),
        ];
        Trajectory::new(times_s.clone(), vec![Vector3::zeros(); 1000])
            .and_then(|path| path.with_joints(joints))
            .unwrap()
    }

    #[test]
    fn clocks_that_differ_are_said_and_a_servo_s_delay_is_not() {
        for (late_s, drift, said) in [
            (0.0, 0.0, None),
            (0.12, 0.0, None),
            (0.3, 0.0, None),
            (-0.2, 0.0, Some("0.200 s before")),
            (0.05, 0.015, Some("in the last")),
            (0.3, -0.02, Some("in the last")),
        ] {
            let doubt = doubt(&followed(late_s, drift), 0.02);
            match said {
                None => assert_eq!(doubt, None, "{late_s} s, {drift}"),
                Some(said) => assert!(
                    doubt.as_deref().is_some_and(|doubt| doubt.contains(said)),
                    "{late_s} s, {drift}: {doubt:?}"
                ),
            }
        }
    }
}
