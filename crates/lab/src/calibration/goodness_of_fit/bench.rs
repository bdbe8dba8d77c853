//! The runs of a study whose residuals are judged: at its best point, with other settings, in place of reality, and from imitated
//! recordings.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::calibration::BaseRule;
use crate::calibration::answer::score::Scores;
use crate::calibration::goodness_of_fit::channel::{Series, axes_of, series_of};
use crate::calibration::goodness_of_fit::imitation::{MeasurementNoise, random, with_recordings};
use crate::calibration::study::Study;
use realgap_core::error::Result;
use realgap_path::trajectory::Trajectory;
use realgap_simulation::{EngineChoice, Experiment, Noise, Start};

/// A change of an experiment.
type Change = Box<dyn Fn(&mut Experiment) + Sync>;

/// The start speed of a joint is changed by this share of its largest speed, which is at least this.
const SPEED_SHARE: f64 = 0.01;
const LEAST_SPEED_RAD_S: f64 = 0.1;
/// The start velocity and the start spin of a body are changed by this, m/s and rad/s.
const VELOCITY_M_S: f64 = 0.01;
const SPIN_RAD_S: f64 = 0.05;

/// The fitted recordings of a study, the point that is judged, and what stays the same for all its runs.
pub(super) struct Bench<'a> {
    pub study: &'a Study,
    engine: Option<EngineChoice>,
    /// The judged cases.
    pub cases: Vec<usize>,
    axes: Vec<[Vector3<f64>; 3]>,
}

/// Of two engines, the one whose runs of the best point come nearer to the recordings: the model explains them where one does.
pub(super) fn engine(study: &Study, scores: &Scores, best: usize) -> Option<EngineChoice> {
    let settings = study.settings();
    let runs = scores.runs_at(&scores.points[best].values);
    let runs = runs.filter_map(|run| Some((run.index, run.score?)));
    let [own, second] = settings.engine_means(&runs.collect::<Vec<_>>());
    let is_nearer = own.zip(second).is_some_and(|(own, second)| second < own);
    settings.second.filter(|_| is_nearer)
}

impl<'a> Bench<'a> {
    pub fn new(study: &'a Study, engine: Option<EngineChoice>) -> Self {
        let all = study.cases().iter();
        let is_fitted = |case: usize| {
            let targets = &study.cases()[case].targets;
            targets.len() == 1 && !study.is_held_out(targets[0].recording)
        };
        let cases: Vec<usize> = (0..all.len()).filter(|case| is_fitted(*case)).collect();
        let axes = cases
            .iter()
            .map(|case| axes_of(&study.cases()[*case].targets[0].motion));
        Self {
            study,
            engine,
            axes: axes.collect(),
            cases,
        }
    }

    /// The run of every case of a study at these values, with a change of its settings; `None` where one diverged.
    pub fn runs(
        &self,
        study: &Study,
        values: &[f64],
        change: &(dyn Fn(&mut Experiment) + Sync),
    ) -> Result<Option<Vec<Trajectory>>> {
        let set = study.parameter_set(values);
        let run = |case: &usize| {
            let mut experiment = study.experiment_with(*case, &set)?;
            if let Some(engine) = self.engine {
                experiment.solver.engine = engine;
            }
            change(&mut experiment);
            Ok(realgap_simulation::run(&experiment)?.outcome.completed())
        };
        let runs: Vec<Option<Trajectory>> =
            self.cases.par_iter().map(run).collect::<Result<_>>()?;
        Ok(runs.into_iter().collect())
    }

    /// The recordings of a study in true lengths.
    pub fn recorded(&self, study: &Study, values: &[f64]) -> Result<Vec<Trajectory>> {
        let scale = study.recording_length_scale(values);
        let recorded = self.cases.iter().map(|case| {
            let target = study.cases()[*case].targets[0].in_true_lengths(scale)?;
            Ok(target.into_owned().motion)
        });
        recorded.collect()
    }

    pub fn series(&self, recorded: &[Trajectory], runs: &[Trajectory]) -> Vec<Vec<Series>> {
        let pairs = recorded.iter().zip(runs).zip(&self.axes);
        let series = pairs.map(|((real, run), axes)| series_of(self.study, axes, real, run));
        series.collect()
    }

    /// The noise of measurement that the recordings show.
    pub fn visible_noise(&self, recorded: &[Trajectory], runs: &[Trajectory]) -> MeasurementNoise {
        let pairs: Vec<(&Trajectory, &Trajectory)> = recorded.iter().zip(runs).collect();
        MeasurementNoise::visible(&pairs, self.study.definition().horizon.is_some())
    }

    /// The noise of measurement that the recordings show, or the study's where that is larger, and what else the study states
    /// about differences between runs that start from recordings.
    pub fn noise(&self, visible: &MeasurementNoise) -> (MeasurementNoise, Option<Noise>) {
        let mut noise = visible.clone();
        let Some(stated) = self.study.definition().noise else {
            return (noise, None);
        };
        let camera = stated.camera;
        noise.plane_m = noise.plane_m.max(camera.position_m.size());
        noise.height_m = noise.height_m.max(camera.position_m.size());
        noise.turn_rad = noise.turn_rad.max(camera.angle_rad.size() / 3.0_f64.sqrt());
        noise.start_velocity = [
            stated.start_velocity_m_s.size(),
            stated.start_spin_rad_s.size(),
        ];
        // The start itself was recorded, up to the noise of measurement.
        let of_runs = Noise {
            start_position_m: Default::default(),
            start_height_m: Default::default(),
            start_tilt_rad: Default::default(),
            start_heading_rad: Default::default(),
            start_velocity_m_s: Default::default(),
            start_spin_rad_s: Default::default(),
            ..stated.without_camera()
        };
        (noise, Some(of_runs))
    }

    /// Runs with another start speed, one list of runs for each number that a start has: each joint, or each direction and axis of
    /// rotation. The speed at a start that was not recorded there is a difference of samples, or a mean over samples around it; both
    /// are wrong where the motion accelerates, and a recording's noise does not say how much. Empty where speeds were recorded.
    pub fn changed_starts(
        &self,
        values: &[f64],
        own: &[Trajectory],
    ) -> Result<Vec<Vec<Trajectory>>> {
        let definition = self.study.definition();
        let targets = self
            .cases
            .iter()
            .map(|case| &self.study.cases()[*case].targets[0].motion);
        let is_recorded = |motion: &Trajectory| match definition.metric.needs().joints {
            true => motion
                .joints()
                .iter()
                .all(|joint| joint.speeds_rad_s.is_some()),
            false => motion.velocities_world_m_s().is_some(),
        };
        if definition.horizon.is_none() && targets.clone().all(is_recorded) {
            return Ok(Vec::new());
        }
        let changes: Vec<Change> = match definition.metric.needs().joints {
            true => joint_speeds(own),
            false => body_speeds(definition.metric.is_pose()),
        };
        let runs = changes
            .iter()
            .map(|change| self.runs(self.study, values, change.as_ref()));
        let runs: Vec<Option<Vec<Trajectory>>> = runs.collect::<Result<_>>()?;
        Ok(runs.into_iter().flatten().collect())
    }

    /// Runs in place of reality that differ as the study states, at half of the timestep.
    pub fn perturbed(
        &self,
        values: &[f64],
        noise: &Noise,
        number: usize,
    ) -> Result<Option<Vec<Trajectory>>> {
        let set = self.study.parameter_set(values);
        let seed = self.study.definition().seed;
        let run = |(position, case): (usize, &usize)| {
            let repeat = (number * self.cases.len() + position) as u64;
            let mut experiment = self.study.experiment_with(*case, &set)?;
            if let Some(engine) = self.engine {
                experiment.solver.engine = engine;
            }
            half_step(&mut experiment);
            let experiment = noise.perturb(&experiment, seed, repeat);
            Ok(realgap_simulation::run(&experiment)?.outcome.completed())
        };
        let cases = self.cases.par_iter().enumerate();
        let runs: Vec<Option<Trajectory>> = cases.map(run).collect::<Result<_>>()?;
        Ok(runs.into_iter().collect())
    }

    /// The study with imitations of its judged recordings.
    pub fn imitation(
        &self,
        values: &[f64],
        truth: &[Trajectory],
        noise: &MeasurementNoise,
        number: usize,
    ) -> Result<Study> {
        let definition = self.study.definition();
        let scale = self.study.recording_length_scale(values);
        let mut trajectories = vec![None; definition.recordings.len()];
        for (position, (case, truth)) in self.cases.iter().zip(truth).enumerate() {
            let target = &self.study.cases()[*case].targets[0];
            let rng = random(definition.seed, number, position, self.cases.len());
            let mut copy = noise.record(truth, &target.motion, scale, rng)?;
            if definition.base == BaseRule::Recorded {
                copy = on_base(copy, &definition.recordings[target.recording].trajectory)?;
            }
            trajectories[target.recording] = Some(copy);
        }
        with_recordings(self.study, trajectories)
    }
}

/// An imitation of the joints of a recording, with the recorded poses along which the base was led.
fn on_base(joints: Trajectory, recorded: &Trajectory) -> Result<Trajectory> {
    let count = joints.len();
    let placed = joints.with_positions(recorded.positions_world_m()[..count].to_vec())?;
    match recorded.orientations_world_from_body() {
        Some(turns) => placed.with_orientations(turns[..count].to_vec()),
        None => Ok(placed),
    }
}

/// A change of the start speed of each joint of these runs.
fn joint_speeds(own: &[Trajectory]) -> Vec<Change> {
    let names = own.iter().flat_map(|run| run.joints());
    let names: BTreeSet<String> = names.map(|joint| joint.name.clone()).collect();
    let change = |name: String| -> Change {
        let speeds = own
            .iter()
            .filter_map(|run| run.joint(&name)?.speeds_rad_s.as_ref());
        let speeds = speeds.flatten().map(|speed| speed.abs());
        let step_rad_s = SPEED_SHARE * speeds.fold(LEAST_SPEED_RAD_S, f64::max);
        Box::new(move |experiment| {
            let mut hinges = experiment.assembly.hinges.iter();
            let hinge = hinges.position(|hinge| hinge.name == name);
            if let Some(start) = hinge.and_then(|at| experiment.start_joints.get_mut(at)) {
                start.speed_rad_s += step_rad_s;
            }
        })
    };
    names.into_iter().map(change).collect()
}

/// A change of the start velocity along each axis and of the start spin about each; of the motion in the plane alone for metrics
/// of paths.
fn body_speeds(is_pose: bool) -> Vec<Change> {
    let change = |axis: usize, is_spin: bool| -> Change {
        Box::new(move |experiment| {
            if let Start::State(state) = &mut experiment.start {
                match is_spin {
                    true => state.angular_velocity_body_rad_s[axis] += SPIN_RAD_S,
                    false => state.velocity_world_m_s[axis] += VELOCITY_M_S,
                }
            }
        })
    };
    let all = [false, true]
        .into_iter()
        .flat_map(|spin| (0..3).map(move |axis| (axis, spin)));
    let in_plane = |(axis, is_spin): &(usize, bool)| is_pose || (*axis == 2) == *is_spin;
    all.filter(in_plane)
        .map(|(axis, is_spin)| change(axis, is_spin))
        .collect()
}

pub(super) fn half_step(experiment: &mut Experiment) {
    experiment.solver.timestep_s *= 0.5;
}

/// Runs that take the place of reality: reality may be what the study simulates, what it simulates at half of its timestep, or
/// the limit of short steps, which is as far beyond the latter for errors of first order (Richardson 1911).
pub(super) struct Truths<'a> {
    pub own: &'a [Trajectory],
    pub finer: &'a [Trajectory],
}

impl Truths<'_> {
    pub fn number(&self, number: usize) -> Result<Vec<Trajectory>> {
        let pairs = self.own.iter().zip(self.finer);
        match number % 3 {
            0 => Ok(self.own.to_vec()),
            1 => Ok(self.finer.to_vec()),
            _ => pairs.map(|(own, finer)| beyond(own, finer)).collect(),
        }
    }
}

/// The motion that is as far from `finer` as that is from `own`, on the other side.
fn beyond(own: &Trajectory, finer: &Trajectory) -> Result<Trajectory> {
    let places = own
        .positions_world_m()
        .iter()
        .zip(finer.positions_world_m());
    let mut limit = finer
        .clone()
        .with_positions(places.map(|(a, b)| 2.0 * b - a).collect())?;
    if let Some((a, b)) = own
        .orientations_world_from_body()
        .zip(finer.orientations_world_from_body())
    {
        let turns = a.iter().zip(b).map(|(a, b)| b * a.inverse() * b);
        limit = limit.with_orientations(turns.collect())?;
    }
    let joints = finer.joints().iter().map(|joint| {
        let mut limit = joint.clone();
        if let Some(own) = own.joint(&joint.name) {
            let angles = own.angles_rad.iter().zip(&joint.angles_rad);
            limit.angles_rad = angles.map(|(a, b)| 2.0 * b - a).collect();
        }
        limit
    });
    let joints = joints.collect();
    limit.with_joints(joints)
}
