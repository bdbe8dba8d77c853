//! Determines the state in which a recording starts: as recorded, corrected by half a sample, or fitted to the flight.

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::flight::Body;
use super::joint_flight::{self, Samples};
use super::solve::line;
use realgap_core::error::Result;
use realgap_path::trajectory::{State, Trajectory};
use realgap_simulation::{Experiment, JointState, Start};

/// Which state of a recording a simulated run starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum StartState {
    /// The first sample as it is recorded.
    #[default]
    FirstSample,
    /// The first sample, with its velocity corrected: a velocity that was computed as a difference of two samples is half a
    /// sample of gravity late (or early, if the file has no velocities and this program computes the difference).
    HalfSampleCorrected,
    /// A state fitted to all samples before the first contact of the same recording.
    Flight,
}

impl StartState {
    /// The text by which reports name this start.
    pub fn label(self) -> &'static str {
        match self {
            Self::FirstSample => "first recorded sample",
            Self::HalfSampleCorrected => {
                "first recorded sample, velocity corrected by half a sample"
            }
            Self::Flight => "fitted to the flight before the first contact of the same recording",
        }
    }
}

/// Fewest samples of flight that give a start state.
pub const LEAST_SAMPLES: usize = 5;
/// The first orientations of a recording are often a transient of the tracker's filter. They are left out as far as
/// [`AFTER_TRANSIENT`] other samples remain.
const TRANSIENT: usize = 3;
const AFTER_TRANSIENT: usize = 6;
/// Rounds of Gauss-Newton for a constant angular velocity. Two rounds suffice usually; the others serve recordings with large
/// turns between samples.
const ROUNDS: usize = 4;

/// A start state fitted to a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightFit {
    /// State at the first sample.
    pub state: State,
    /// State of the joints at the first sample; empty for a rigid robot.
    pub joints: Vec<JointState>,
    /// Number of samples of the flight.
    pub samples: usize,
    /// Root mean square distance of the centre of mass from its parabola, metres; for a jointed robot, of the recorded from the
    /// fitted position of the tracked point.
    pub residual_m: f64,
}

/// The state at the first sample that fits the flight best. The centre of mass moves on a parabola. A rigid robot turns at a
/// constant angular velocity in the world frame, which is exact if its moments of inertia are equal; the rotation of a jointed robot
/// is simulated from its mass properties. `motion` is in true lengths.
///
/// `None` if fewer than [`LEAST_SAMPLES`] samples are in flight, or if the fit of a jointed robot fails.
pub fn fit_flight(body: &Body, motion: &Trajectory) -> Option<FlightFit> {
    let samples = body.flight_samples(motion);
    if samples < LEAST_SAMPLES {
        return None;
    }
    if let Some(linkage) = &body.linkage {
        let recorded = Samples::new(linkage, motion, samples)?;
        let fit = joint_flight::fit(linkage, body.gravity_m_s2, &recorded, None)?;
        let (state, joints) = fit.state(linkage);
        return Some(FlightFit {
            state,
            joints,
            samples,
            residual_m: fit.residual_m(),
        });
    }
    let orientations = &motion.orientations_world_from_body()?[..samples];
    let start_s = motion.times_s()[0];
    let times_s: Vec<f64> = motion.times_s()[..samples]
        .iter()
        .map(|t| t - start_s)
        .collect();
    let skipped = TRANSIENT.min(samples.saturating_sub(AFTER_TRANSIENT));
    let (turned, rate_world) = spin(&times_s[skipped..], &orientations[skipped..]);
    let attitude = |t_s: f64| UnitQuaternion::from_scaled_axis(rate_world * t_s) * turned;

    let n = samples as f64;
    let centres: Vec<Vector3<f64>> = times_s
        .iter()
        .zip(motion.positions_world_m())
        .map(|(&t, p)| {
            let fall = Vector3::z() * (0.5 * body.gravity_m_s2 * t * t);
            p + attitude(t) * body.centre_track_m + fall
        })
        .collect();
    let (centre, velocity) = line(&times_s, &centres);
    let squares: f64 = times_s
        .iter()
        .zip(&centres)
        .map(|(t, c)| (c - centre - velocity * *t).norm_squared())
        .sum();
    let arm = turned * body.centre_track_m;
    Some(FlightFit {
        state: State {
            position_world_m: centre - arm,
            orientation_world_from_body: turned,
            velocity_world_m_s: velocity - rate_world.cross(&arm),
            angular_velocity_body_rad_s: turned.inverse() * rate_world,
        },
        joints: Vec::new(),
        samples,
        residual_m: (squares / n).sqrt(),
    })
}

/// Orientation at time 0 and constant angular velocity (world frame, rad/s) of samples, by Gauss–Newton on the rotation vectors
/// of the residual turns.
fn spin(
    times_s: &[f64],
    orientations: &[UnitQuaternion<f64>],
) -> (UnitQuaternion<f64>, Vector3<f64>) {
    let n = times_s.len() as f64;
    let mean_s = times_s.iter().sum::<f64>() / n;
    let spread: f64 = times_s.iter().map(|t| (t - mean_s).powi(2)).sum();
    let mut rate = orientations
        .windows(2)
        .map(|w| (w[1] * w[0].inverse()).scaled_axis())
        .sum::<Vector3<f64>>()
        / (times_s[times_s.len() - 1] - times_s[0]);
    let middle = times_s.len() / 2;
    let mut attitude =
        UnitQuaternion::from_scaled_axis(rate * (mean_s - times_s[middle])) * orientations[middle];
    for _ in 0..ROUNDS {
        let errors: Vec<Vector3<f64>> = times_s
            .iter()
            .zip(orientations)
            .map(|(t, q)| {
                let predicted = UnitQuaternion::from_scaled_axis(rate * (t - mean_s)) * attitude;
                (q * predicted.inverse()).scaled_axis()
            })
            .collect();
        attitude =
            UnitQuaternion::from_scaled_axis(errors.iter().sum::<Vector3<f64>>() / n) * attitude;
        rate += times_s
            .iter()
            .zip(&errors)
            .map(|(t, e)| e * (t - mean_s))
            .sum::<Vector3<f64>>()
            / spread;
    }
    (
        UnitQuaternion::from_scaled_axis(rate * -mean_s) * attitude,
        rate,
    )
}

/// Which rule gave a start state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refined {
    /// The start follows the rule that was asked for.
    AsAsked,
    /// The recording has no flight to fit, so the velocity is corrected by half a sample instead.
    NoFlight,
}

/// The experiment with its start refined according to `rule`, from its own recording in recorded lengths.
///
/// Centre of mass, gravity and length scale are taken from the experiment, so its parameters must be set before this call.
///
/// # Errors
/// [`StartState::Flight`] for a robot with servos.
pub fn refine(
    rule: StartState,
    experiment: Experiment,
    recorded: &Trajectory,
) -> Result<(Experiment, Refined)> {
    refine_again(rule, experiment, recorded, &mut None)
}

/// The result of an earlier fit of a flight and the body for which it holds. It can be used again as long as a study changes
/// parameters of contact only.
#[derive(Debug, Clone)]
pub struct KnownFlight {
    body: Body,
    scale: f64,
    fit: Option<FlightFit>,
}

/// Like [`refine`], but uses the result of an earlier call for the same recording again where it still holds, and stores a new
/// result in `known`.
///
/// # Errors
/// As [`refine`].
pub fn refine_again(
    rule: StartState,
    mut experiment: Experiment,
    recorded: &Trajectory,
    known: &mut Option<KnownFlight>,
) -> Result<(Experiment, Refined)> {
    let Start::State(first) = experiment.start else {
        return Ok((experiment, Refined::AsAsked));
    };
    let scale = experiment.recording_length_scale;
    let half_sample = || {
        let half_s = 0.5 * (recorded.times_s()[1] - recorded.times_s()[0]);
        // A recorded velocity is taken as a backward difference; a velocity that this program computes is a forward difference.
        let late_s = match recorded.velocities_world_m_s() {
            Some(_) => half_s,
            None => -half_s,
        };
        State {
            velocity_world_m_s: first.velocity_world_m_s
                - Vector3::z() * (experiment.gravity_m_s2 * scale * late_s),
            ..first
        }
    };
    let (state, refined) = match rule {
        StartState::FirstSample => (first, Refined::AsAsked),
        StartState::HalfSampleCorrected => (half_sample(), Refined::AsAsked),
        StartState::Flight => {
            let body = Body::new(&experiment)?;
            let is_known = known
                .as_ref()
                .is_some_and(|known| known.scale == scale && known.body == body);
            if !is_known {
                *known = Some(KnownFlight {
                    fit: fit_flight(&body, &recorded.scaled(1.0 / scale)?),
                    body,
                    scale,
                });
            }
            match known.as_ref().and_then(|known| known.fit.clone()) {
                Some(fit) => {
                    if !fit.joints.is_empty() {
                        experiment.start_joints = fit.joints;
                    }
                    (fit.state.scaled(scale), Refined::AsAsked)
                }
                None => (half_sample(), Refined::NoFlight),
            }
        }
    };
    experiment.start = Start::State(state);
    Ok((experiment, refined))
}
