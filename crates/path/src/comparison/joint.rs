//! The metric of joint angles, which needs no pose at all.

use std::f64::consts::TAU;

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::{Interpolator, JointTrack, Trajectory};
use realgap_core::error::{Error, Result};
use realgap_core::stated;
use realgap_core::unit::Unit;

/// Mean absolute error of the angles of the joints that both trajectories have, over every recorded sample, radians.
///
/// No preparation: times count from each trajectory's own start, and the simulation is interpolated at the recorded times.
/// Recorded samples after the end of the simulation are left out.
#[derive(Debug, Clone, Copy)]
pub struct Joints;

impl Metric for Joints {
    stated! {
        name: &'static str = "joints";
        column: &'static str = "joints_rad";
        unit: Unit = Unit::Radian;
        doc: &'static str = "mean absolute error of the joints' angles, by name, over every recorded sample";
        needs: Needs = Needs {
            joints: true,
            ..Needs::default()
        };
        is_symmetric: bool = false;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (mean_rad, samples) = joint_error_rad(pair.real, pair.simulated)?;
        Ok(Measurement::new(mean_rad, samples))
    }
}

/// Joints that both have, by name.
pub(super) fn common<'a>(
    real: &'a Trajectory,
    simulated: &'a Trajectory,
) -> Vec<(&'a JointTrack, &'a JointTrack)> {
    let joints = real.joints().iter();
    joints
        .filter_map(|joint| Some((joint, simulated.joint(&joint.name)?)))
        .collect()
}

/// Mean absolute difference of joints at `since_start_s`, recorded sample number `sample`, radians, each within half a turn.
pub(super) fn error_at_rad(
    joints: &[(&JointTrack, &JointTrack)],
    at: &mut Interpolator<'_>,
    since_start_s: f64,
    sample: usize,
) -> f64 {
    let errors = joints.iter().map(|(recorded, joint)| {
        let error = at.joint_angle_rad(joint, since_start_s) - recorded.angles_rad[sample];
        (error - TAU * (error / TAU).round()).abs()
    });
    errors.sum::<f64>() / joints.len() as f64
}

/// Mean absolute error of the joints' angles, radians, and the number of recorded samples compared.
///
/// # Errors
/// No joint that both have.
pub fn joint_error_rad(real: &Trajectory, simulated: &Trajectory) -> Result<(f64, usize)> {
    let joints = common(real, simulated);
    if joints.is_empty() {
        let names = |motion: &Trajectory| {
            let names: Vec<&str> = motion.joints().iter().map(|j| j.name.as_str()).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        return Err(Error::invalid("the trajectories have no joint in common")
            .found(format!("{}; {}", names(real), names(simulated)))
            .allowed("a column NAME_rad for a hinge of that name"));
    }
    let start_s = real.times_s()[0];
    let end_s = simulated.duration_s() * (1.0 + 1e-9) + 1e-9;
    let mut at = Interpolator::new(simulated);
    let (mut sum_rad, mut samples) = (0.0, 0);
    for (sample, time_s) in real.times_s().iter().enumerate() {
        let since_start_s = time_s - start_s;
        if since_start_s > end_s {
            break;
        }
        sum_rad += error_at_rad(&joints, &mut at, since_start_s, sample);
        samples += 1;
    }
    Ok((sum_rad / samples as f64, samples))
}
