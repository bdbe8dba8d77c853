//! The metric `joints`, which compares joint angles and needs no poses.

use std::f64::consts::TAU;

use super::metric::{Context, Measurement, Metric, Needs, Pair};
use crate::trajectory::{Interpolator, JointTrack, Trajectory, resolution};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;

/// Mean absolute error of the joint angles over all recorded samples, for the joints that both trajectories have, radians.
///
/// The trajectories are not prepared: times are counted from each trajectory's own start, and the simulation is interpolated at the recorded
/// times. Recorded samples after the end of the simulation are left out.
#[derive(Debug, Clone, Copy)]
pub struct Joints;

impl Metric for Joints {
    constant_methods! {
        name: &'static str = "joints";
        column: &'static str = "joints_rad";
        unit: Unit = Unit::Radian;
        doc: &'static str = "mean absolute error of the joints' angles, by name, over every recorded sample";
        needs: Needs = Needs {
            joints: true,
            ..Needs::default()
        };
        is_symmetric: bool = false;
        has_errors: bool = true;
    }

    fn errors(&self, pair: &Pair<'_>, most: usize) -> Result<Option<Vec<f64>>> {
        let joints = common(pair.real, pair.simulated);
        let times_s = pair.real.times_s();
        let mut at = Interpolator::new(pair.simulated);
        let samples = || samples(times_s.len(), joints.len(), most);
        let mut errors = Vec::with_capacity(joints.len() * samples().count());
        for joint in &joints {
            for sample in samples() {
                let since_start_s = times_s[sample] - times_s[0];
                errors.push(difference_rad(joint, &mut at, since_start_s, sample));
            }
        }
        Ok(Some(errors))
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (mean_rad, samples) = joint_error_rad(pair.real, pair.simulated)?;
        Ok(Measurement::new(mean_rad, samples))
    }
}

/// Indices of the samples whose errors are kept, so that there are about `most` errors of all joints. The first sample is left out,
/// because the simulation starts with the recorded angles.
pub(super) fn samples(recorded: usize, joints: usize, most: usize) -> impl Iterator<Item = usize> {
    let each = (recorded * joints).div_ceil(most.max(1)).max(1);
    (each / 2 + 1..recorded).step_by(each)
}

/// The errors of one joint among those of [`Joints`], which come joint after joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointErrorSeries<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// Number of errors.
    pub count: usize,
    /// Step between the recorded angles, radians; 0 where none shows.
    pub resolution_rad: f64,
}

/// How the errors of the metric [`Joints`] are ordered: by joint, for the recorded joints that are simulated.
pub fn joint_error_series<'a>(
    real: &'a Trajectory,
    is_simulated: impl Fn(&str) -> bool,
    most: usize,
) -> Vec<JointErrorSeries<'a>> {
    let joints = real.joints().iter();
    let joints: Vec<&JointTrack> = joints.filter(|joint| is_simulated(&joint.name)).collect();
    let count = samples(real.times_s().len(), joints.len(), most).count();
    let series = joints.iter().map(|joint| JointErrorSeries {
        joint: &joint.name,
        count,
        resolution_rad: resolution(&joint.angles_rad).unwrap_or(0.0),
    });
    series.collect()
}

/// The joints that both trajectories have, matched by name.
pub(super) fn common<'a>(
    real: &'a Trajectory,
    simulated: &'a Trajectory,
) -> Vec<(&'a JointTrack, &'a JointTrack)> {
    let joints = real.joints().iter();
    joints
        .filter_map(|joint| Some((joint, simulated.joint(&joint.name)?)))
        .collect()
}

/// Mean absolute difference of the joint angles at `since_start_s`, the time of the recorded sample with index `sample`, radians; each
/// difference is wrapped to half a turn.
pub(super) fn error_at_rad(
    joints: &[(&JointTrack, &JointTrack)],
    at: &mut Interpolator<'_>,
    since_start_s: f64,
    sample: usize,
) -> f64 {
    let errors = joints
        .iter()
        .map(|joint| difference_rad(joint, at, since_start_s, sample).abs());
    errors.sum::<f64>() / joints.len() as f64
}

/// Simulated angle minus recorded angle, radians, wrapped to half a turn.
pub(super) fn difference_rad(
    (recorded, simulated): &(&JointTrack, &JointTrack),
    at: &mut Interpolator<'_>,
    since_start_s: f64,
    sample: usize,
) -> f64 {
    let error = at.joint_angle_rad(simulated, since_start_s) - recorded.angles_rad[sample];
    error - TAU * (error / TAU).round()
}

/// The error of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointError {
    /// Name of the joint.
    pub name: String,
    /// Mean absolute error over the recorded samples, radians.
    pub mean_rad: f64,
    /// Absolute error at the last of these samples, radians.
    pub end_rad: f64,
}

/// The error of every joint that both trajectories have, over the recorded samples within the simulation.
pub fn joint_errors(real: &Trajectory, simulated: &Trajectory) -> Vec<JointError> {
    let times_s = real.times_s();
    let end_s = simulated.duration_s() * (1.0 + 1e-9) + 1e-9;
    let samples = times_s.partition_point(|t| t - times_s[0] <= end_s);
    let joints = common(real, simulated);
    let error = |joint: &(&JointTrack, &JointTrack)| {
        let mut at = Interpolator::new(simulated);
        let off = |(k, t): (usize, &f64)| difference_rad(joint, &mut at, t - times_s[0], k).abs();
        let errors: Vec<f64> = times_s[..samples].iter().enumerate().map(off).collect();
        JointError {
            name: joint.0.name.clone(),
            mean_rad: errors.iter().sum::<f64>() / errors.len() as f64,
            end_rad: errors[errors.len() - 1],
        }
    };
    joints.iter().map(error).collect()
}

/// The recorded and the simulated angles of a joint at the recorded samples.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSamples {
    /// Name of the joint.
    pub name: String,
    /// Times since the start of the recording, seconds.
    pub times_s: Vec<f64>,
    /// Recorded angles, radians.
    pub recorded_rad: Vec<f64>,
    /// Simulated angles, radians, each wrapped to within half a turn of the recorded angle.
    pub simulated_rad: Vec<f64>,
}

/// The angles of every joint that both trajectories have, at the recorded samples within the simulation.
pub fn joint_samples(real: &Trajectory, simulated: &Trajectory) -> Vec<JointSamples> {
    let times_s = real.times_s();
    let end_s = simulated.duration_s() * (1.0 + 1e-9) + 1e-9;
    let since_start = times_s.iter().map(|t| t - times_s[0]);
    let times_s: Vec<f64> = since_start.take_while(|t| *t <= end_s).collect();
    let joint = |joint: &(&JointTrack, &JointTrack)| {
        let mut at = Interpolator::new(simulated);
        let recorded = &joint.0.angles_rad;
        let simulated = times_s.iter().enumerate();
        let simulated = simulated.map(|(k, t)| recorded[k] + difference_rad(joint, &mut at, *t, k));
        JointSamples {
            name: joint.0.name.clone(),
            simulated_rad: simulated.collect(),
            recorded_rad: recorded[..times_s.len()].to_vec(),
            times_s: times_s.clone(),
        }
    };
    common(real, simulated).iter().map(joint).collect()
}

/// Mean absolute error of the joint angles, radians, and the number of compared samples.
///
/// # Errors
/// No joint that both trajectories have.
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
            .allowed("a column NAME_rad for a hinge with the name NAME"));
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
