//! Estimates the centre of mass, the apparent gravity and the lag of recorded velocities of a rigid robot from free flight.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::bootstrap::{Interval, intervals, weighted_mean};
use super::flight::{Body, EQUAL_MOMENTS};
use super::rest::RestReport;
use super::solve::Equations;
use super::start::{LEAST_SAMPLES, fit_flight};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::{Recording, State, Trajectory};
use realgap_simulation::{Experiment, JointState};

/// How an apparent gravity that differs from the stated gravity is interpreted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthReading {
    /// Gravity is as stated, and recorded lengths are wrong by the ratio (an error of the camera calibration).
    #[default]
    LengthScale,
    /// Recorded lengths are right, and gravity has its apparent value.
    Gravity,
}

/// A recording without flight.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Grounded {
    /// Name of the recording.
    pub recording: String,
    /// Number of samples in flight, which is too small for an estimate.
    pub flight_samples: usize,
}

/// Start state of one recording, fitted to its flight, in recorded lengths.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FlightStart {
    /// Name of the recording.
    pub recording: String,
    /// Samples in flight.
    pub flight_samples: usize,
    /// Position of the tracked point, world frame, metres.
    pub position_world_m: [f64; 3],
    /// Orientation, world from body: w, x, y, z.
    pub orientation_world_from_body_wxyz: [f64; 4],
    /// Velocity of the tracked point, world frame, m/s.
    pub velocity_world_m_s: [f64; 3],
    /// Angular velocity, body frame, rad/s.
    pub angular_velocity_body_rad_s: [f64; 3],
    /// Angles of the joints, in the order of the robot's hinges, radians.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_angles_rad: Vec<f64>,
    /// Speeds of the joints, in the order of the robot's hinges, rad/s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_speeds_rad_s: Vec<f64>,
    /// Root mean square distance of the centre of mass from its parabola, metres; for jointed robots, of the recorded from the
    /// fitted position of the tracked point.
    pub residual_m: f64,
}

impl FlightStart {
    pub(super) fn new(
        recording: &Recording,
        flight_samples: usize,
        state: &State,
        joints: &[JointState],
        residual_m: f64,
    ) -> Self {
        let q = state.orientation_world_from_body;
        Self {
            recording: recording.name.clone(),
            flight_samples,
            position_world_m: state.position_world_m.into(),
            orientation_world_from_body_wxyz: [q.w, q.i, q.j, q.k],
            velocity_world_m_s: state.velocity_world_m_s.into(),
            angular_velocity_body_rad_s: state.angular_velocity_body_rad_s.into(),
            joint_angles_rad: joints.iter().map(|joint| joint.angle_rad).collect(),
            joint_speeds_rad_s: joints.iter().map(|joint| joint.speed_rad_s).collect(),
            residual_m,
        }
    }
}

/// The estimate without the first samples of every flight, where trackers often have transients.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Trimmed {
    /// Samples left out at the start of every flight.
    pub first_samples_left_out: usize,
    /// Centre of mass in the body frame, recorded lengths, metres.
    pub centre_of_mass_m: [f64; 3],
    /// Apparent gravity downwards, m/s².
    pub gravity_m_s2: f64,
    /// Root mean square residual of the positions per axis, metres.
    pub residual_m: f64,
}

/// The properties of a rigid robot that were identified from flights. Intervals are 95 % bootstrap intervals over recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Identification {
    /// Number of recordings that were examined.
    pub recordings: usize,
    /// Number of recordings with a flight.
    pub flying: usize,
    /// Number of samples in flight, over all recordings.
    pub samples: usize,
    /// Recordings without a flight.
    pub grounded: Vec<Grounded>,
    /// Centre of mass in the body frame, in recorded lengths, metres: x, y, z.
    pub centre_of_mass_recorded_m: [Interval; 3],
    /// Acceleration of the centre of mass in recorded lengths, world frame, m/s²: x, y, z.
    pub acceleration_world_m_s2: [Interval; 3],
    /// Downward component of the acceleration of the centre of mass, in recorded lengths, m/s².
    pub apparent_gravity_m_s2: Interval,
    /// Apparent divided by stated gravity. If gravity is as stated, this is the ratio of recorded lengths to true lengths.
    pub length_scale: Interval,
    /// Delay of the recorded velocities, seconds; `None` without recorded velocities.
    pub velocity_lag_s: Option<Interval>,
    /// Half the time between samples, seconds: the lag of a backward difference.
    pub half_sample_s: f64,
    /// Root mean square distance of the positions from the fitted parabolas per axis, metres.
    pub residual_m: f64,
    /// The estimate without the first samples of every flight.
    pub sensitivity: Vec<Trimmed>,
    /// Resting poses.
    pub rest: RestReport,
    /// Values for `--parameters`, in true lengths.
    pub parameters: BTreeMap<String, f64>,
    /// Start states, one for each flight.
    pub starts: Vec<FlightStart>,
    /// Warnings, for example where the flights contradict the stated model.
    pub warnings: Vec<Warning>,
}

/// Estimates the properties of a rigid robot from recordings and the stated robot, floor height and gravity.
/// `experiment.recording_length_scale` is not used, because it is one of the quantities to be estimated.
///
/// # Errors
/// A robot with servos, no recording with a flight, or flights that do not turn.
pub fn identify(
    experiment: &Experiment,
    recordings: &[Recording],
    reading: LengthReading,
    seed: u64,
) -> Result<Identification> {
    let body = Body::new(experiment)?;
    if body.linkage.is_some() {
        return Err(
            Error::invalid("the robot has hinges").hint("`identify_joints` is for jointed robots")
        );
    }
    let counted_samples = recordings
        .iter()
        .map(|recording| (recording, body.flight_samples(&recording.trajectory)));
    let (flights, grounded) = part_flights(counted_samples);
    if flights.is_empty() {
        return Err(Error::invalid("none of the recordings has a flight")
            .found(format!("{}, on or near the floor (or without orientations) from the start", counted(recordings.len(), "recording")))
            .allowed(format!("at least {LEAST_SAMPLES} samples before any part of the robot comes near the floor"))
            .hint("walking robots are never in free flight: toss or drop the robot and record that; if it was in flight, check floor.height_m and the length unit"));
    }
    let still = || {
        Error::invalid(
            "the robot hardly turns in the flights, so its centre of mass cannot be estimated",
        )
        .found(format!("{} flights", flights.len()))
        .hint("toss the robot with a spin")
    };
    let equations: Vec<Equations> = flights
        .iter()
        .filter_map(|(recording, end)| Equations::new(&recording.trajectory, 0, *end))
        .collect();
    let solved = intervals(equations.len(), seed, |weights| {
        Equations::sum(&equations, weights).solve()
    })
    .ok_or_else(still)?;
    let values = solved.map(|interval| interval.value);
    let [cx, cy, cz, gx, gy, gz] = solved;
    let apparent = Interval {
        value: -gz.value,
        low: -gz.high,
        high: -gz.low,
    };
    let scale = apparent.times(1.0 / experiment.gravity_m_s2);
    let whole = vec![1.0; equations.len()];
    let residual_m = Equations::sum(&equations, &whole).residual_m(&values);

    let mut fitted_body = body.clone();
    fitted_body.centre_track_m = Vector3::new(cx.value, cy.value, cz.value);
    fitted_body.gravity_m_s2 = apparent.value;
    let (starts, lags) = starts_and_lags(&fitted_body, &flights);
    let velocity_lag_s = intervals(lags.len(), seed, |weights| weighted_mean(weights, &lags));
    let half_sample_s = {
        let motion = &flights[0].0.trajectory;
        0.5 * motion.duration_s() / (motion.len() - 1) as f64
    };

    let motions: Vec<&Trajectory> = recordings.iter().map(|r| &r.trajectory).collect();
    let rest = RestReport::new(&body, &motions, seed);
    let mut found = Identification {
        recordings: recordings.len(),
        flying: flights.len(),
        samples: flights.iter().map(|(_, samples)| samples).sum(),
        grounded,
        centre_of_mass_recorded_m: [cx, cy, cz],
        acceleration_world_m_s2: [gx, gy, gz],
        apparent_gravity_m_s2: apparent,
        length_scale: scale,
        velocity_lag_s: velocity_lag_s.map(|[lag]| lag),
        half_sample_s,
        residual_m,
        sensitivity: sensitivity(&flights),
        rest,
        parameters: parameters(experiment, reading, &body, &[cx, cy, cz], &apparent)?,
        starts,
        warnings: Vec::new(),
    };
    found.warnings = warnings(&body, &found);
    Ok(found)
}

/// Splits recordings into those with enough samples of flight for an estimate, and the others.
pub(super) fn part_flights<'a>(
    counted: impl Iterator<Item = (&'a Recording, usize)>,
) -> (Vec<(&'a Recording, usize)>, Vec<Grounded>) {
    let (flights, grounded): (Vec<_>, Vec<_>) =
        counted.partition(|(_, samples)| *samples >= LEAST_SAMPLES);
    let grounded = grounded
        .into_iter()
        .map(|(recording, flight_samples)| Grounded {
            recording: recording.name.clone(),
            flight_samples,
        });
    (flights, grounded.collect())
}

/// The start of every flight that can be fitted with this body, and the delay of its recorded velocities, seconds.
fn starts_and_lags(body: &Body, flights: &[(&Recording, usize)]) -> (Vec<FlightStart>, Vec<f64>) {
    let mut starts = Vec::new();
    let mut lags = Vec::new();
    for (recording, _) in flights {
        let motion = &recording.trajectory;
        if let Some(fit) = fit_flight(body, motion) {
            let (samples, residual_m) = (fit.samples, fit.residual_m);
            starts.push(FlightStart::new(
                recording,
                samples,
                &fit.state,
                &[],
                residual_m,
            ));
            // v(t − lag) = v(t) + g·lag: the difference between a late and the true velocity is proportional to the lag.
            lags.extend(motion.velocities_world_m_s().map(|recorded| {
                (recorded[0].z - fit.state.velocity_world_m_s.z) / body.gravity_m_s2
            }));
        }
    }
    (starts, lags)
}

/// The estimate without the first 0, 3 and 5 samples of every flight.
fn sensitivity(flights: &[(&Recording, usize)]) -> Vec<Trimmed> {
    [0, 3, 5]
        .into_iter()
        .filter_map(|first| {
            let equations: Vec<Equations> = flights
                .iter()
                .filter(|(_, end)| *end >= first + LEAST_SAMPLES)
                .filter_map(|(recording, end)| Equations::new(&recording.trajectory, first, *end))
                .collect();
            let sum = Equations::sum(&equations, &vec![1.0; equations.len()]);
            let values = sum.solve()?;
            Some(Trimmed {
                first_samples_left_out: first,
                centre_of_mass_m: [values[0], values[1], values[2]],
                gravity_m_s2: -values[5],
                residual_m: sum.residual_m(&values),
            })
        })
        .collect()
}

/// The parameters that make the stated robot agree with the flights, where they contradict it.
fn parameters(
    experiment: &Experiment,
    reading: LengthReading,
    stated: &Body,
    centre_recorded_m: &[Interval; 3],
    apparent: &Interval,
) -> Result<BTreeMap<String, f64>> {
    let scale = match reading {
        LengthReading::LengthScale => apparent.value / experiment.gravity_m_s2,
        LengthReading::Gravity => 1.0,
    };
    // On an axis on which the flights do not contradict the stated centre, the stated value is kept, because the difference may be
    // noise.
    let centre_m = Vector3::from_fn(|axis, _| {
        let seen = &centre_recorded_m[axis];
        if seen.contains(stated.centre_track_m[axis]) {
            stated.centre_track_m[axis]
        } else {
            seen.value / scale
        }
    });
    // The centre of mass is linear in the offsets of the cubes, which may be turned against each other.
    let centre_with = |offset_m: Vector3<f64>| {
        let mut shifted = experiment.clone();
        shifted.adjustment.centre_of_mass_offset_m = offset_m;
        Body::new(&shifted).map(|body| body.centre_track_m)
    };
    let centred = centre_with(Vector3::zeros())?;
    let mut response = Matrix3::zeros();
    for axis in 0..3 {
        response.set_column(axis, &(centre_with(Vector3::ith(axis, 1.0))? - centred));
    }
    let mut values = BTreeMap::new();
    if let Some(offset) = response.lu().solve(&(centre_m - centred)) {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(offset.iter()) {
            values.insert(format!("body.com_offset_{axis}_m"), *value);
        }
    }
    match reading {
        LengthReading::LengthScale => values.insert("recording.length_scale".to_owned(), scale),
        LengthReading::Gravity => values.insert("gravity_m_s2".to_owned(), apparent.value),
    };
    Ok(values)
}

/// Warnings about contradictions between the flights and the stated model, and about limits of the estimate.
fn warnings(stated: &Body, found: &Identification) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let ratio = |i: &Interval| format!("{:.4} ({:.4} to {:.4})", i.value, i.low, i.high);
    for (axis, (interval, stated_m)) in ["x", "y", "z"].iter().zip(
        found
            .centre_of_mass_recorded_m
            .iter()
            .zip(stated.centre_track_m.iter()),
    ) {
        if !interval.contains(*stated_m) {
            warnings.push(Code::CentreOfMassContradicted.warning(format!(
                "the stated centre of mass is at {axis} = {:.2} mm, the flights give {:.2} mm ({:.2} to {:.2})",
                1e3 * stated_m,
                1e3 * interval.value,
                1e3 * interval.low,
                1e3 * interval.high
            )));
        }
    }
    if !found.length_scale.contains(1.0) {
        let gravity = &found.apparent_gravity_m_s2;
        let rest = found
            .rest
            .height_ratio
            .as_ref()
            .map_or(String::new(), |rest| {
                format!(
                    "; the height at rest is {} times the height that follows from the robot's size",
                    ratio(rest)
                )
            });
        warnings.push(Code::GravityContradicted.warning(format!(
            "the flights fall at {:.3} m/s^2 ({:.3} to {:.3}) instead of {:.3}: if gravity is right, recorded lengths are {} times the true lengths{rest}",
            gravity.value,
            gravity.low,
            gravity.high,
            stated.gravity_m_s2,
            ratio(&found.length_scale)
        )));
    }
    if let Some(lag) = found.velocity_lag_s
        && !lag.contains(0.0)
    {
        warnings.push(Code::VelocitiesLate.warning(format!(
            "recorded velocities are {:.2} ms late ({:.2} to {:.2}); half a sample is {:.2} ms, which is what a backward difference gives",
            1e3 * lag.value,
            1e3 * lag.low,
            1e3 * lag.high,
            1e3 * found.half_sample_s
        )));
    }
    if stated.moment_ratio > EQUAL_MOMENTS {
        warnings.push(Code::UnequalMoments.warning(format!(
            "the moments of inertia differ by a factor of {:.2}: the fitted start states assume a constant angular velocity",
            stated.moment_ratio
        )));
    }
    if !found.grounded.is_empty() {
        warnings.push(Code::NoFlight.warning(format!(
            "{} of {} recordings have no flight and do not contribute to the estimate",
            found.grounded.len(),
            found.recordings
        )));
    }
    warnings
}
