//! Estimates masses, centres of mass, inertias and hinge friction of a robot of parts on passive hinges from free flight, and
//! determines which of these parameters the flights do not determine.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::bootstrap::{Interval, draws_of};
use super::estimate::{FlightStart, Grounded, LengthReading, part_flights};
use super::flight::Body;
use super::joint_flight::{JointFit, Residual, Samples, fit, flown, slopes};
use super::joint_prior::{Prior, priors, set};
use super::linkage::{Attitude, Linkage};
use super::start::LEAST_SAMPLES;
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{mean, median, percentile_interval};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::Recording;
use realgap_simulation::Experiment;

/// Flights determine a parameter if its standard deviation is below this share of the prior's standard deviation.
const DETERMINED: f64 = 0.5;
/// Rounds of Gauss-Newton over all flights.
const ROUNDS: usize = 5;
/// Change of a parameter by which flights are differentiated, in standard deviations of the prior.
const NUDGE: f64 = 1e-3;
/// A recording whose residual is more than this factor times the median residual is not treated as a free flight.
const ODD: f64 = 4.0;
/// Share of a flight that is fitted in order to predict the rest of the flight.
const SEEN: f64 = 2.0 / 3.0;
/// Share of the bootstrap estimates on either side of an interval of 95 %.
const TAIL: f64 = 0.025;

/// The result of the identification for one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointVerdict {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value in the robot's file.
    pub stated: f64,
    /// Estimate with its 95 % interval (bootstrap over recordings); the stated value if flights do not determine the parameter.
    pub estimate: Interval,
    /// Standard deviation after the flights divided by that of the prior: 1 if flights contain no information about the parameter.
    pub left_of_prior: f64,
    /// Whether flights determine the parameter.
    pub is_determined: bool,
}

/// Errors of fitted or predicted flights compared with the recordings: medians over recordings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FlightErrors {
    /// Error of the position of the tracked point, metres.
    pub position_m: f64,
    /// Error of the rotation of the tracked part, degrees.
    pub rotation_deg: f64,
    /// Mean absolute error of the joint angles, degrees.
    pub hinge_deg: f64,
}

/// The properties of a jointed robot that were identified from flights.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointIdentification {
    /// Number of recordings that were examined.
    pub recordings: usize,
    /// Number of recordings with a flight.
    pub flying: usize,
    /// Number of samples in flight, over all recordings.
    pub samples: usize,
    /// Recordings without a flight.
    pub grounded: Vec<Grounded>,
    /// The result for each parameter.
    pub verdicts: Vec<JointVerdict>,
    /// Errors at the last sample of each flight if the whole flight is fitted, with the robot as stated.
    pub last_sample_as_stated: FlightErrors,
    /// Errors at the last sample of each flight if the whole flight is fitted, with the identified parameters.
    pub last_sample: FlightErrors,
    /// Errors at the last sample of each flight if only its first two thirds are fitted, with the robot as stated.
    pub predicted_as_stated: FlightErrors,
    /// Errors at the last sample of each flight if only its first two thirds are fitted, with the identified parameters.
    pub predicted: FlightErrors,
    /// Root mean square residual of the positions, metres.
    pub residual_m: f64,
    /// Values for `--parameters`, in true lengths, of the parameters that flights determine.
    pub parameters: BTreeMap<String, f64>,
    /// Start states, one for each flight, in recorded lengths.
    pub starts: Vec<FlightStart>,
    /// Warnings, for example where the flights contradict the robot's description.
    pub warnings: Vec<Warning>,
}

/// Estimates the parameters of a robot on passive hinges from recordings of its flights.
///
/// # Errors
/// A robot with servos or without hinges, no recording with a flight.
pub fn identify_joints(
    experiment: &Experiment,
    recordings: &[Recording],
    reading: LengthReading,
    seed: u64,
) -> Result<JointIdentification> {
    let priors = priors(experiment, reading)?;
    let body = Body::new(experiment)?;
    let mut counted_samples = Vec::new();
    for recording in recordings {
        let scale = 1.0 / experiment.recording_length_scale;
        let motion = recording.trajectory.scaled(scale)?;
        counted_samples.push((recording, body.flight_samples(&motion)));
    }
    let (flights, grounded) = part_flights(counted_samples.into_iter());
    let flights = flights.into_iter();
    let mut flights: Vec<Flight<'_>> = flights
        .map(|(recording, count)| Flight { recording, count })
        .collect();
    let all: Vec<usize> = (0..priors.len()).collect();
    let nothing = || {
        Error::invalid("none of the recordings has a flight that can be fitted")
            .found(counted(recordings.len(), "recording"))
            .allowed(format!("at least {LEAST_SAMPLES} samples, with all joints, before any part of the robot comes near the floor"))
    };
    let odd = leave_out_odd(experiment, &mut flights)?;
    let first = solve(experiment, &priors, &all, &flights, seed)?.ok_or_else(nothing)?;
    let mut known = all.clone();
    known.retain(|index| first.left_of_prior[*index] < DETERMINED);
    let last = solve(experiment, &priors, &known, &flights, seed)?.ok_or_else(nothing)?;
    let mut verdicts = Vec::new();
    let mut parameters = BTreeMap::new();
    for (index, prior) in priors.iter().enumerate() {
        let place = known.iter().position(|k| *k == index);
        let [value, low, high] = [prior.stated; 3];
        let as_stated = Interval { value, low, high };
        let estimate = place.map_or(as_stated, |place| last.estimates[place]);
        if place.is_some() {
            parameters.insert(prior.parameter.name.to_owned(), estimate.value);
        }
        verdicts.push(JointVerdict {
            parameter: prior.parameter.name,
            stated: prior.stated,
            estimate,
            left_of_prior: first.left_of_prior[index],
            is_determined: place.is_some(),
        });
    }
    let identified = set(&priors, &known, &last.values)?.apply(experiment);
    let fits = fit_all(&identified, &flights)?;
    let mut warnings = warnings(&verdicts, &grounded, recordings.len());
    if !odd.is_empty() {
        warnings.push(Code::NoFlight.warning(format!(
            "{} of {} flights are not free flights of this robot (their residual is more than {ODD} times the median) and are left out: {}",
            odd.len(),
            odd.len() + flights.len(),
            odd.join(", ")
        )));
    }
    Ok(JointIdentification {
        recordings: recordings.len(),
        flying: flights.len(),
        samples: flights.iter().map(|flight| flight.count).sum(),
        grounded,
        last_sample_as_stated: errors(experiment, &flights, 1.0)?,
        last_sample: errors(&identified, &flights, 1.0)?,
        predicted_as_stated: errors(experiment, &flights, SEEN)?,
        predicted: errors(&identified, &flights, SEEN)?,
        residual_m: rms(&fits),
        starts: starts(&identified, &flights, &fits)?,
        verdicts,
        parameters,
        warnings,
    })
}

/// Removes flights that no start state explains, for example because the robot was still held or touched something on the way.
/// Returns the names of the recordings.
fn leave_out_odd(experiment: &Experiment, flights: &mut Vec<Flight<'_>>) -> Result<Vec<String>> {
    let misfits: Vec<f64> = fit_all(experiment, flights)?
        .iter()
        .map(|fit| fit.as_ref().map_or(f64::INFINITY, JointFit::misfit))
        .collect();
    let limit = ODD * median(&misfits);
    let mut odd = Vec::new();
    let mut index = 0;
    flights.retain(|flight| {
        let is_odd = misfits[index] > limit;
        if is_odd {
            odd.push(flight.recording.name.clone());
        }
        index += 1;
        !is_odd
    });
    Ok(odd)
}

/// One recorded flight and its number of samples.
struct Flight<'a> {
    recording: &'a Recording,
    count: usize,
}

impl Flight<'_> {
    /// The first `count` samples in true lengths.
    fn samples(&self, model: &Model, count: usize) -> Result<Option<Samples>> {
        let motion = self.recording.trajectory.scaled(1.0 / model.length_scale)?;
        Ok(Samples::new(&model.linkage, &motion, count))
    }

    /// The normal equations of this flight for the parameters that differ in the nudged models, with the start of the flight
    /// eliminated; `None` if the flight cannot be fitted.
    fn equations(
        &self,
        model: &Model,
        nudged: &[Model],
        from: Option<&Attitude>,
    ) -> Result<Option<FlightEquations>> {
        let Some(samples) = self.samples(model, self.count)? else {
            return Ok(None);
        };
        let Some(found) = fit(&model.linkage, model.gravity_m_s2, &samples, from) else {
            return Ok(None);
        };
        let here = found.weighted();
        let Some(own) = slopes(&model.linkage, model.gravity_m_s2, &samples, &found) else {
            return Ok(None);
        };
        let mut shared = DMatrix::zeros(here.len(), nudged.len());
        for (k, other) in nudged.iter().enumerate() {
            let Some(samples) = self.samples(other, self.count)? else {
                continue;
            };
            let there = flown(&other.linkage, other.gravity_m_s2, &samples, &found.start);
            if let Some(there) = there {
                shared.set_column(k, &((there.weighted() - &here) / NUDGE));
            }
        }
        let Some(factors) = (own.transpose() * &own).cholesky() else {
            return Ok(None);
        };
        let across = own.transpose() * &shared;
        let clear = &shared - &own * factors.solve(&across);
        Ok(Some(FlightEquations {
            matrix: clear.transpose() * &clear,
            slope: clear.transpose() * &here,
            squares: here.norm_squared(),
            // The position and velocity of the centre of mass are fitted, too, which takes six more degrees of freedom.
            freedom: (here.len() as f64 - own.ncols() as f64 - 6.0).max(0.0),
            fit: found,
        }))
    }
}

/// Normal equations of one flight for the parameters that all flights share.
struct FlightEquations {
    matrix: DMatrix<f64>,
    slope: DVector<f64>,
    squares: f64,
    freedom: f64,
    fit: JointFit,
}

/// The properties of an experiment that determine a flight.
struct Model {
    linkage: Linkage,
    gravity_m_s2: f64,
    length_scale: f64,
}

impl Model {
    fn new(experiment: &Experiment) -> Result<Self> {
        let linkage = Body::new(experiment)?.linkage.ok_or_else(|| {
            Error::invalid("the robot has no hinges")
                .hint("a rigid robot is identified by `identify`")
        })?;
        Ok(Self {
            linkage,
            gravity_m_s2: experiment.gravity_m_s2,
            length_scale: experiment.recording_length_scale,
        })
    }
}

/// The estimated parameters.
struct Solution {
    /// Deviations from the stated values.
    values: Vec<f64>,
    estimates: Vec<Interval>,
    /// Standard deviations after the flights divided by those of the priors.
    left_of_prior: Vec<f64>,
}

/// Gauss-Newton over all flights at once, each with a start of its own that is eliminated (Schur complement).
fn solve(
    experiment: &Experiment,
    priors: &[Prior],
    free: &[usize],
    flights: &[Flight<'_>],
    seed: u64,
) -> Result<Option<Solution>> {
    let size = free.len();
    let mut values = vec![0.0; size];
    let mut fits: Vec<Option<JointFit>> = vec![None; flights.len()];
    let mut equations: Vec<(DMatrix<f64>, DVector<f64>)> = Vec::new();
    let mut noise = 1.0;
    for round in 0..=ROUNDS {
        let model = Model::new(&set(priors, free, &values)?.apply(experiment))?;
        let nudged = (0..size)
            .map(|k| {
                let mut moved = values.clone();
                moved[k] += NUDGE;
                Model::new(&set(priors, free, &moved)?.apply(experiment))
            })
            .collect::<Result<Vec<_>>>()?;
        equations.clear();
        let (mut squares, mut freedom) = (0.0, 0.0);
        for (flight, known) in flights.iter().zip(&mut fits) {
            let from = known.as_ref().map(|fit| &fit.start);
            let Some(one) = flight.equations(&model, &nudged, from)? else {
                continue;
            };
            squares += one.squares;
            freedom += one.freedom;
            equations.push((one.matrix, one.slope));
            *known = Some(one.fit);
        }
        if equations.is_empty() {
            return Ok(None);
        }
        noise = squares / freedom.max(1.0);
        if round == ROUNDS || size == 0 {
            break;
        }
        let Some(step) = step(&equations, &vec![1.0; equations.len()], noise, &values) else {
            break;
        };
        for (value, step) in values.iter_mut().zip(step.iter()) {
            // A value of more than five standard deviations of the prior is implausible.
            *value = (*value + step).clamp(-5.0, 5.0);
        }
        if step.amax() < 1e-3 && round > 0 {
            break;
        }
    }
    let drawn = draws_of(equations.len(), seed, |weights| {
        step(&equations, weights, noise, &values)
    });
    let estimates = (0..size).map(|k| {
        let prior = &priors[free[k]];
        let moved: Vec<f64> = drawn.iter().map(|step| values[k] + step[k]).collect();
        let (low, high) = percentile_interval(&moved, TAIL).unwrap_or((values[k], values[k]));
        let [value, low, high] = [values[k], low, high].map(|u| prior.value(u));
        Interval { value, low, high }
    });
    let estimates = estimates.collect();
    let mut total = DMatrix::zeros(size, size);
    for (matrix, _) in &equations {
        total += matrix / noise;
    }
    total += DMatrix::identity(size, size);
    let left_of_prior = match total.try_inverse() {
        Some(inverse) => (0..size).map(|k| inverse[(k, k)].max(0.0).sqrt()).collect(),
        None => vec![1.0; size],
    };
    Ok(Some(Solution {
        values,
        estimates,
        left_of_prior,
    }))
}

/// The Gauss-Newton step from the equations, each multiplied by its weight, and the priors.
fn step(
    equations: &[(DMatrix<f64>, DVector<f64>)],
    weights: &[f64],
    noise: f64,
    values: &[f64],
) -> Option<DVector<f64>> {
    let size = values.len();
    let mut matrix = DMatrix::identity(size, size) * noise;
    let mut right = DVector::from_column_slice(values) * noise;
    for ((own, slope), weight) in equations.iter().zip(weights) {
        matrix += own * *weight;
        right += slope * *weight;
    }
    Some(-matrix.cholesky()?.solve(&right))
}

fn fit_all(experiment: &Experiment, flights: &[Flight<'_>]) -> Result<Vec<Option<JointFit>>> {
    let model = Model::new(experiment)?;
    flights
        .iter()
        .map(|flight| {
            let samples = flight.samples(&model, flight.count)?;
            Ok(samples.and_then(|s| fit(&model.linkage, model.gravity_m_s2, &s, None)))
        })
        .collect()
}

/// Errors at the last sample of each flight if the first `share` of the flight is fitted.
fn errors(experiment: &Experiment, flights: &[Flight<'_>], share: f64) -> Result<FlightErrors> {
    let model = Model::new(experiment)?;
    let mut last = Vec::new();
    for flight in flights {
        let seen = ((flight.count as f64 * share).round() as usize).max(LEAST_SAMPLES);
        let (Some(whole), Some(part)) = (
            flight.samples(&model, flight.count)?,
            flight.samples(&model, seen.min(flight.count))?,
        ) else {
            continue;
        };
        let found = fit(&model.linkage, model.gravity_m_s2, &part, None);
        last.extend(found.and_then(|found| ahead(&model, &whole, &found)));
    }
    let of = |value: fn(&Residual) -> f64| median(&last.iter().map(value).collect::<Vec<_>>());
    if last.is_empty() {
        return Err(Error::invalid("no flight could be fitted"));
    }
    Ok(FlightErrors {
        position_m: of(|residual| residual.position_m.norm()),
        rotation_deg: of(|residual| residual.turn_rad.norm().to_degrees()),
        hinge_deg: of(|residual| {
            let errors: Vec<f64> = residual.joints_rad.iter().map(|e| e.abs()).collect();
            mean(&errors).to_degrees()
        }),
    })
}

/// Residual at the last sample of the whole flight of a fit to the beginning of the flight.
fn ahead(model: &Model, whole: &Samples, found: &JointFit) -> Option<Residual> {
    let last = whole.len() - 1;
    let time_s = whole.times_s[last];
    let end = model.linkage.fly(&found.start, &whole.times_s)?.pop()?;
    let fall = nalgebra::Vector3::z() * (0.5 * model.gravity_m_s2 * time_s * time_s);
    let centre = found.centre_m + found.velocity_m_s * time_s - fall;
    let at = centre - end.world_from_body * model.linkage.centre_m(&end.angles_rad);
    Some(Residual::of(
        whole,
        last,
        whole.positions_m[last] - at,
        &end,
    ))
}

fn rms(fits: &[Option<JointFit>]) -> f64 {
    let found = fits.iter().flatten();
    let squares: Vec<f64> = found.map(|fit| fit.residual_m().powi(2)).collect();
    mean(&squares).sqrt()
}

fn starts(
    experiment: &Experiment,
    flights: &[Flight<'_>],
    fits: &[Option<JointFit>],
) -> Result<Vec<FlightStart>> {
    let model = Model::new(experiment)?;
    let pairs = flights.iter().zip(fits);
    let pairs = pairs.filter_map(|(flight, fit)| Some((flight, fit.as_ref()?)));
    Ok(pairs
        .map(|(flight, fit)| {
            let (state, joints) = fit.state(&model.linkage);
            let state = state.scaled(model.length_scale);
            let residual_m = fit.residual_m();
            FlightStart::new(flight.recording, flight.count, &state, &joints, residual_m)
        })
        .collect())
}

fn warnings(verdicts: &[JointVerdict], grounded: &[Grounded], recordings: usize) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let contradicted: Vec<String> = verdicts
        .iter()
        .filter(|v| v.is_determined && !v.estimate.contains(v.stated))
        .map(|v| {
            let Interval { value, low, high } = v.estimate;
            format!(
                "{} {value:.4} ({low:.4} to {high:.4}), stated {}",
                v.parameter, v.stated
            )
        })
        .collect();
    if !contradicted.is_empty() {
        warnings.push(Code::BodyContradicted.warning(format!(
            "flights contradict the robot's description: {}",
            contradicted.join("; ")
        )));
    }
    if !grounded.is_empty() {
        warnings.push(Code::NoFlight.warning(format!(
            "{} of {recordings} recordings have no flight and do not contribute to the estimate",
            grounded.len()
        )));
    }
    warnings
}
