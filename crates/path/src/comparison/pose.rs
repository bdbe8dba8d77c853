//! Metrics that include orientation: `rotation` on matched samples or prepared points, `pose` on the recorded samples.

use serde::Serialize;

use super::evo::orientations;
use super::joint;
use super::metric::{Context, Measurement, Metric, Needs, Pair};
use super::pose_residual::pose_residuals;
use crate::trajectory::{Interpolator, Trajectory};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;
use realgap_core::warning::{Code, Warning};

/// Mean angle of R_real⁻¹ R_sim, degrees, over the matched samples as they are, or over the prepared (resampled and turned) orientations
/// where no samples are matched.
#[derive(Debug, Clone, Copy)]
pub struct Rotation;

impl Metric for Rotation {
    constant_methods! {
        name: &'static str = "rotation";
        column: &'static str = "rotation_deg";
        unit: Unit = Unit::Degree;
        doc: &'static str = "evo's absolute pose error, rotation angle, mean";
        needs: Needs = Needs {
            orientation: true,
            ..Needs::POINTS
        };
        is_of_samples: bool = true;
    }

    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let Some([a, b]) = orientations(pair) else {
            return Err(
                Error::invalid("a trajectory was prepared without orientations")
                    .field("rotation")
                    .hint("prepare it again from the recording"),
            );
        };
        let sum_rad: f64 = a.iter().zip(b).map(|(p, q)| p.angle_to(q)).sum();
        let mean_rad = sum_rad / a.len() as f64;
        Ok(Measurement::new(mean_rad.to_degrees(), a.len()))
    }
}

/// Mean position error / body length + mean rotation error in radians + mean joint error in radians, over every recorded sample.
///
/// The trajectories are not prepared: both are counted from their own start time in the same world frame, and the simulation is
/// interpolated at the recorded times. See [`pose_errors`] for the parts.
#[derive(Debug, Clone, Copy)]
pub struct Pose;

impl Metric for Pose {
    constant_methods! {
        name: &'static str = "pose";
        column: &'static str = "pose";
        unit: Unit = Unit::One;
        doc: &'static str = "mean position error / body length + mean errors of rotation and of joints (if both have them) in radians, over every recorded sample";
        needs: Needs = Needs {
            preparation: false,
            basis: false,
            spread: false,
            orientation: true,
            body_length: true,
            joints: false,
        };
        is_symmetric: bool = false;
        is_pose: bool = true;
        has_errors: bool = true;
    }

    fn errors(&self, pair: &Pair<'_>, most: usize) -> Result<Option<Vec<f64>>> {
        Ok(pose_residuals(pair, most))
    }

    fn measure(&self, pair: &Pair<'_>, context: &Context<'_>) -> Result<Measurement> {
        let body_length_m = context.body_length_m.unwrap_or(f64::NAN);
        let errors = pose_errors(pair.real, pair.simulated, body_length_m)?;
        Ok(Measurement {
            value: errors.score(),
            samples: errors.samples,
            warnings: errors.warnings,
        })
    }
}

/// The errors of simulated poses against the recorded poses, on average and at the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PoseErrors {
    /// Mean position error, as a fraction of the body length.
    pub position_fraction_mean: f64,
    /// Mean rotation error, radians.
    pub rotation_rad_mean: f64,
    /// Mean error of the joints that both trajectories have, radians, each wrapped to half a turn; `None` if there are no such joints.
    pub joint_rad_mean: Option<f64>,
    /// Position error at the last compared sample, as a fraction of the body length.
    pub position_fraction_final: f64,
    /// Rotation error at the last compared sample, radians.
    pub rotation_rad_final: f64,
    /// Mean error of the joints at the last compared sample, radians; `None` if there are no such joints.
    pub joint_rad_final: Option<f64>,
    /// Number of recorded samples that were compared.
    pub samples: usize,
    /// The warning `shorter-simulation`, if the simulation ended before the recording.
    pub warnings: Vec<Warning>,
}

impl PoseErrors {
    /// The value of the metric `pose`.
    pub fn score(&self) -> f64 {
        self.position_fraction_mean + self.rotation_rad_mean + self.joint_rad_mean.unwrap_or(0.0)
    }
}

/// Position and rotation errors of `simulated` at every sample time of `real`.
///
/// Joints are compared by name; joints that only one trajectory has are left out. Times are counted from each trajectory's own start.
/// Positions are compared in all three dimensions, or in the x-y plane if either trajectory is planar. Recorded samples after the end of
/// the simulation are left out, with a warning.
///
/// # Errors
/// Missing orientations, or a body length that is not a positive number of metres.
pub fn pose_errors(
    real: &Trajectory,
    simulated: &Trajectory,
    body_length_m: f64,
) -> Result<PoseErrors> {
    if !(body_length_m > 0.0 && body_length_m.is_finite()) {
        return Err(Error::invalid("the body length must be positive")
            .field("body_length_m")
            .found(body_length_m)
            .allowed("more than 0 m"));
    }
    let (Some(orientations), Some(_)) = (
        real.orientations_world_from_body(),
        simulated.orientations_world_from_body(),
    ) else {
        return Err(
            Error::invalid("pose errors need orientations in both trajectories")
                .allowed("columns qw,qx,qy,qz"),
        );
    };
    let planar = real.is_planar() || simulated.is_planar();
    let start_s = real.times_s()[0];
    // The sum of timesteps may differ from the recorded end by rounding; such a simulation does not count as shorter.
    let end_s = simulated.duration_s() * (1.0 + 1e-9) + 1e-9;
    let mut at = Interpolator::new(simulated);
    let (mut position_sum_m, mut rotation_sum_rad) = (0.0, 0.0);
    let (mut position_m, mut rotation_rad) = (0.0, 0.0);
    let joints = joint::common(real, simulated);
    let (mut joint_sum_rad, mut joint_rad) = (0.0, 0.0);
    let mut samples = 0_usize;
    for ((time_s, recorded), q) in real
        .times_s()
        .iter()
        .zip(real.positions_world_m())
        .zip(orientations)
    {
        let since_start_s = time_s - start_s;
        if since_start_s > end_s {
            break;
        }
        let offset = at.position_world_m(since_start_s) - recorded;
        position_m = if planar {
            offset.xy().norm()
        } else {
            offset.norm()
        };
        rotation_rad = at
            .orientation_world_from_body(since_start_s)
            .map_or(0.0, |simulated| q.angle_to(&simulated));
        if !joints.is_empty() {
            joint_rad = joint::error_at_rad(&joints, &mut at, since_start_s, samples);
            joint_sum_rad += joint_rad;
        }
        position_sum_m += position_m;
        rotation_sum_rad += rotation_rad;
        samples += 1;
    }
    let mut warnings = Vec::new();
    if samples < real.len() {
        warnings.push(Code::ShorterSimulation.warning(format!(
            "the trajectory ends after {:.6} s: {} of {} recorded samples were not compared",
            simulated.duration_s(),
            real.len() - samples,
            real.len()
        )));
    }
    let n = samples as f64;
    Ok(PoseErrors {
        position_fraction_mean: position_sum_m / n / body_length_m,
        rotation_rad_mean: rotation_sum_rad / n,
        joint_rad_mean: (!joints.is_empty()).then_some(joint_sum_rad / n),
        joint_rad_final: (!joints.is_empty()).then_some(joint_rad),
        position_fraction_final: position_m / body_length_m,
        rotation_rad_final: rotation_rad,
        samples,
        warnings,
    })
}
