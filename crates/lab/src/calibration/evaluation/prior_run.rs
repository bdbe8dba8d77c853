//! Runs before anything is fitted: does the simulated robot move at all as far as the recorded one, and do its recorded commands
//! have an effect?

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::calibration::{Case, Study};
use realgap_core::Result;
use realgap_core::statistics::{ends_of, mean, standard_deviation};
use realgap_core::unit::Unit;
use realgap_optimization::RunOptions;
use realgap_path::comparison::joint_error_rad;
use realgap_path::trajectory::{JointTrack, Trajectory, resolution};
use realgap_simulation::Experiment;
use realgap_simulation::parameter::ParameterSet;

/// The parameter values of a run before the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PriorPoint {
    /// The robot as its file describes it.
    OwnValues,
    /// The middle of every range.
    Middle,
}

impl PriorPoint {
    /// Both points.
    pub const ALL: [Self; 2] = [Self::OwnValues, Self::Middle];

    /// Description, as the end of a sentence.
    pub fn label(self) -> &'static str {
        match self {
            Self::OwnValues => "with the robot's own values",
            Self::Middle => "in the middle of the ranges",
        }
    }
}

/// A run of one recording before the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorRun {
    /// The parameter values.
    pub point: PriorPoint,
    /// Name of the recording.
    pub recording: String,
    /// How far the recorded robot moves: the largest distance from the start, metres; for joints alone the largest range of an
    /// angle, radians.
    pub recorded: f64,
    /// How far the simulated robot moves; `None` if the run diverged.
    pub simulated: Option<f64>,
    /// Unit of both: metres or radians.
    pub unit: Unit,
    /// Mean error of the joints, radians, where joints alone were recorded.
    pub joint_error_rad: Option<f64>,
    /// Mean over the recorded joints of the standard deviation of their angles, radians.
    pub joint_spread_rad: f64,
    /// How many times farther than at their start two runs get from each other whose joints start 0.1 mrad apart, where joints
    /// alone were recorded.
    pub growth: Option<f64>,
    /// Mean change of the joints' angles where the timestep is halved, radians, where joints alone were recorded.
    pub step_change_rad: Option<f64>,
    /// Mean over the recorded joints of the standard deviation of their rounding, radians; 0 where no step of an encoder shows.
    pub rounding_rad: f64,
}

/// What runs before the fit show.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PriorRuns {
    /// One per point and recording.
    pub runs: Vec<PriorRun>,
    /// Joints whose recorded commands change nothing when they are doubled.
    pub idle_commands: Vec<String>,
}

/// A simulated robot that moves less than this share of what was recorded does not do what was recorded.
const STILL: f64 = 0.1;

impl PriorRun {
    /// Whether the simulated robot moves less than a tenth as far as the recorded one.
    pub fn stands_still(&self) -> bool {
        self.simulated
            .is_some_and(|moved| moved < STILL * self.recorded)
    }
}

impl PriorRuns {
    /// The run that moves least in relation to its recording, if no run moves a tenth as far as was recorded.
    pub fn standing_still(&self) -> Option<&PriorRun> {
        let completed = || self.runs.iter().filter(|run| run.simulated.is_some());
        let all_stand = completed().all(PriorRun::stands_still);
        let share =
            |run: &PriorRun| run.simulated.unwrap_or(0.0) / run.recorded.max(f64::MIN_POSITIVE);
        completed()
            .filter(|_| all_stand)
            .max_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// The number of runs that diverged.
    pub fn diverged(&self) -> usize {
        self.runs
            .iter()
            .filter(|run| run.simulated.is_none())
            .count()
    }

    /// The smallest mean error of the joints over the two points, radians.
    pub fn joint_error_rad(&self) -> Option<f64> {
        let of = |point: PriorPoint| {
            let runs = self.runs.iter().filter(|run| run.point == point);
            let errors: Vec<f64> = runs.filter_map(|run| run.joint_error_rad).collect();
            (!errors.is_empty()).then(|| mean(&errors))
        };
        PriorPoint::ALL
            .into_iter()
            .filter_map(of)
            .min_by(f64::total_cmp)
    }

    /// The largest change of the joints where the timestep is halved, and the largest that a fit does not see, if the first is larger:
    /// a tenth of what the fit may leave.
    pub fn coarse_step_rad(&self) -> Option<(f64, f64)> {
        let changes = self.runs.iter().filter_map(|run| run.step_change_rad);
        let change_rad = changes.max_by(f64::total_cmp)?;
        let roundings = self.runs.iter().map(|run| run.rounding_rad);
        let rounding_rad = roundings.min_by(f64::total_cmp)?;
        let left_rad = (LEFT * self.joint_error_rad()?).max(rounding_rad);
        (change_rad > UNSEEN * left_rad).then_some((change_rad, UNSEEN * left_rad))
    }

    /// The largest [`PriorRun::growth`].
    pub fn growth(&self) -> Option<f64> {
        let all = self.runs.iter().filter_map(|run| run.growth);
        all.max_by(f64::total_cmp)
    }

    /// Mean over the runs of [`PriorRun::joint_spread_rad`]: an error of this size is as large as that of a joint that stands still.
    pub fn joint_spread_rad(&self) -> f64 {
        mean(
            &self
                .runs
                .iter()
                .map(|run| run.joint_spread_rad)
                .collect::<Vec<f64>>(),
        )
    }
}

/// How far apart two runs start whose distance is followed, radians.
const NUDGE_RAD: f64 = 1e-4;

/// A fit leaves at least about this share of the error before it: of real servos a third to a half.
const LEFT: f64 = 0.2;
/// A change below this share of what a fit leaves moves no parameter by what matters.
const UNSEEN: f64 = 0.1;

/// The mean change of the joints with half of the timestep; `None` if that run diverges.
fn step_change_rad(experiment: &Experiment, motion: &Trajectory) -> Result<Option<f64>> {
    let mut finer = experiment.clone();
    finer.solver.timestep_s *= 0.5;
    let outcome = realgap_simulation::run(&finer)?.outcome;
    let Some(other) = outcome.get() else {
        return Ok(None);
    };
    let joints = motion.joints().iter().zip(other.joints());
    let pairs = joints.flat_map(|(a, b)| a.angles_rad.iter().zip(&b.angles_rad));
    let apart: Vec<f64> = pairs.map(|(a, b)| (a - b).abs()).collect();
    Ok((!apart.is_empty()).then(|| mean(&apart)))
}

/// The standard deviation of rounding to the step of a joint's encoder.
fn rounding_rad(joint: &JointTrack) -> f64 {
    resolution(&joint.angles_rad).map_or(0.0, |step_rad| step_rad / 12.0_f64.sqrt())
}

/// How many times farther apart than at their start two runs get; `None` if the second diverges.
fn growth(experiment: &Experiment, motion: &Trajectory) -> Result<Option<f64>> {
    let mut nudged = experiment.clone();
    for joint in &mut nudged.start_joints {
        joint.angle_rad += NUDGE_RAD;
    }
    let outcome = realgap_simulation::run(&nudged)?.outcome;
    Ok(outcome
        .get()
        .map(|other| joints_apart_rad(motion, other) / NUDGE_RAD))
}

/// A difference below this share of the recorded motion is no effect of a command.
const NO_EFFECT: f64 = 1e-6;

impl Study {
    /// Simulates at most `most` runs of the study, evenly spread over its recordings, with the robot's own values and in the middle
    /// of the ranges, and once more per commanded joint with that joint's commands doubled.
    ///
    /// # Errors
    /// A run that cannot be set up, or the work was stopped.
    pub fn prior_runs(&self, most: usize, run: &RunOptions<'_>) -> Result<PriorRuns> {
        let count = self.cases().len();
        let cases: Vec<usize> = match count <= most {
            true => (0..count).collect(),
            false => (0..most)
                .map(|k| (2 * k + 1) * count / (2 * most))
                .collect(),
        };
        let point = |point: PriorPoint| match point {
            PriorPoint::OwnValues => ParameterSet::new(),
            PriorPoint::Middle => {
                let middle = self
                    .definition()
                    .grid
                    .ranges()
                    .iter()
                    .map(|range| range.at(0.5));
                self.parameter_set(&middle.collect::<Vec<f64>>())
            }
        };
        let runs = run.each(2 * cases.len(), |index| {
            let at = PriorPoint::ALL[index % 2];
            let case = cases[index / 2];
            let experiment = self.experiment_with(case, &point(at))?;
            let outcome = realgap_simulation::run(&experiment)?.outcome;
            let mut prior = self.prior_run(at, &self.cases()[case], outcome.get())?;
            prior.growth = match outcome.get() {
                Some(motion) if prior.joint_error_rad.is_some() => growth(&experiment, motion)?,
                _ => None,
            };
            if let (PriorPoint::OwnValues, Some(motion), true) =
                (at, outcome.get(), prior.joint_error_rad.is_some())
            {
                prior.step_change_rad = step_change_rad(&experiment, motion)?;
            }
            // The doubled commands are compared with the run of the robot's own values.
            let own = outcome.get().filter(|_| at == PriorPoint::OwnValues);
            Ok((prior, own.cloned().map(|motion| (experiment, motion))))
        })?;
        let (runs, own): (Vec<PriorRun>, Vec<Option<(Experiment, Trajectory)>>) =
            runs.into_iter().unzip();
        let own: Vec<(Experiment, Trajectory)> = own.into_iter().flatten().collect();
        Ok(PriorRuns {
            runs,
            idle_commands: idle_commands(&own, run)?,
        })
    }

    fn prior_run(
        &self,
        point: PriorPoint,
        case: &Case,
        simulated: Option<&Trajectory>,
    ) -> Result<PriorRun> {
        let target = &case.targets[0];
        let recorded = &target.motion;
        let is_of_joints = recorded.is_of_joints();
        let joint_error_rad = match (is_of_joints, simulated) {
            (true, Some(motion)) => Some(joint_error_rad(recorded, motion)?.0),
            _ => None,
        };
        // Columns of commands are tracks of joints, too, but no motion.
        let hinges = &case.experiment.assembly.hinges;
        let is_hinge = |joint: &&JointTrack| hinges.iter().any(|hinge| hinge.name == joint.name);
        let joints: Vec<&JointTrack> = recorded.joints().iter().filter(is_hinge).collect();
        let spreads = joints.iter().map(|j| standard_deviation(&j.angles_rad));
        let spreads: Vec<f64> = spreads.collect();
        let joint_spread_rad = if spreads.is_empty() {
            0.0
        } else {
            mean(&spreads)
        };
        Ok(PriorRun {
            point,
            recording: self.definition().recordings[target.recording].name.clone(),
            recorded: moved(recorded, &joints, is_of_joints),
            simulated: simulated.map(|motion| moved(motion, &joints, is_of_joints)),
            unit: if is_of_joints {
                Unit::Radian
            } else {
                Unit::Metre
            },
            joint_error_rad,
            joint_spread_rad,
            growth: None,
            step_change_rad: None,
            rounding_rad: match joints.is_empty() {
                true => 0.0,
                false => mean(&joints.iter().map(|j| rounding_rad(j)).collect::<Vec<f64>>()),
            },
        })
    }
}

/// Joints whose recorded commands change nothing in any of these runs when they are doubled.
fn idle_commands(runs: &[(Experiment, Trajectory)], run: &RunOptions<'_>) -> Result<Vec<String>> {
    let names: BTreeSet<&String> = runs
        .iter()
        .flat_map(|(experiment, _)| experiment.commands.keys())
        .collect();
    let names: Vec<&String> = names.into_iter().collect();
    let is_idle = run.each(names.len(), |index| {
        for (experiment, motion) in runs {
            let Some(track) = experiment.commands.get(names[index]) else {
                continue;
            };
            let mut changed = experiment.clone();
            let doubled = Arc::new(track.scaled(2.0));
            changed.commands.insert(names[index].clone(), doubled);
            let outcome = realgap_simulation::run(&changed)?.outcome;
            if outcome.get().is_none_or(|other| !are_alike(motion, other)) {
                return Ok(false);
            }
        }
        Ok(true)
    })?;
    let all = names.into_iter().zip(is_idle);
    Ok(all
        .filter(|(_, is_idle)| *is_idle)
        .map(|(name, _)| name.clone())
        .collect())
}

/// How far a robot moves: from its start, or the largest range of an angle of `joints` where joints alone were recorded.
fn moved(motion: &Trajectory, joints: &[&JointTrack], is_of_joints: bool) -> f64 {
    if !is_of_joints {
        // A settled robot may sink or tip at its start, so heights do not count.
        let start = motion.positions_world_m()[0].xy();
        let distances = motion
            .positions_world_m()
            .iter()
            .map(|p| (p.xy() - start).norm());
        return distances.fold(0.0, f64::max);
    }
    let own = joints.iter().filter_map(|joint| motion.joint(&joint.name));
    own.map(|joint| {
        let (low, high) = ends_of(joint.angles_rad.iter().copied());
        high - low
    })
    .fold(0.0, f64::max)
}

/// Whether two runs hardly differ in the robot's path and its joints.
fn are_alike(a: &Trajectory, b: &Trajectory) -> bool {
    let apart_m = a.positions_world_m().iter().zip(b.positions_world_m());
    let apart_m = apart_m.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    apart_m < NO_EFFECT * a.extent_m().max(1.0) && joints_apart_rad(a, b) < NO_EFFECT
}

/// The largest difference of a joint's angle in two runs.
fn joints_apart_rad(a: &Trajectory, b: &Trajectory) -> f64 {
    let joints = a.joints().iter().zip(b.joints());
    joints
        .flat_map(|(a, b)| a.angles_rad.iter().zip(&b.angles_rad))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
