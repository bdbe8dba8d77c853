//! One robot: built, put down, repeated under noise; and what that is worth.

use rayon::prelude::*;
use serde::Serialize;

use super::body::Body;
use super::descriptor::{Behaviour, descriptor_named};
use super::failure::{Failure, Reason};
use super::file::Hunt;
use super::objective::Distance;
use super::plan::Plan;
use crate::robot::genome::{Gene, Genome};
use crate::robot::morphology::Morphology;
use crate::simulation::{self, Experiment, Floor, Posture, Solver, settle, watch};
use crate::store::{Outcome, OutcomeStatus, Trial};
use crate::trajectory::prepare;
use crate::warning::Code;
use crate::{Error, Result};

/// A robot with what it is worth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// Position in the search's order, from 0.
    pub index: usize,
    /// The genome.
    pub genome: Genome,
    /// Fitness in the unit of the objective's measure; `None` for a failure.
    pub fitness: Option<f64>,
    /// Why there is no fitness.
    pub failure: Option<Failure>,
    /// Mean net displacement over the repeats, metres.
    pub mean_displacement_m: Option<f64>,
    /// Values of the archive's axes; empty without an archive.
    pub descriptors: Vec<f64>,
}

/// The body is looked at this often, in steps: flight and overlap last longer than that.
const LOOK_EVERY_STEPS: usize = 4;

impl Hunt {
    /// Name of a robot.
    pub fn robot_name(&self, index: usize) -> String {
        format!("robot_{index:05}")
    }

    /// The experiment of one repeat of a robot: drawn parameters, then noise.
    ///
    /// # Errors
    /// None for a validated search.
    pub fn repeat(&self, base: &Experiment, seed: u64, number: u64) -> Result<Experiment> {
        let drawn = self.doubt.draw(seed, number)?.apply(base);
        Ok(self.noise.perturb(&drawn, seed, number))
    }

    /// Simulates one robot. Repeat 0 goes first: a robot that fails there is not repeated, and one that fails in any
    /// repeat has failed, so that this saves time without changing any result. Uses the current rayon pool; the result does not depend
    /// on it.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn evaluate(&self, index: usize, genome: &Genome) -> Result<Trial> {
        let outcomes = match self.build(index, genome)? {
            Err(failure) => vec![failed(&failure)],
            Ok(robot) => self.repeats_of(&robot, self.seed, self.repeats, None)?,
        };
        Ok(Trial {
            index,
            values: genome.genes().iter().flat_map(|g| *g.values()).collect(),
            outcomes,
        })
    }

    /// The robot of a genome if it is worth simulating.
    fn build(
        &self,
        index: usize,
        genome: &Genome,
    ) -> Result<std::result::Result<Morphology, Failure>> {
        let fail = |reason, seen: &dyn std::fmt::Display| Ok(Err(Failure::new(reason, seen)));
        let robot = match self.body.build(&self.robot_name(index), genome) {
            Ok(robot) => robot,
            Err(misfit) => return fail(Reason::DoesNotDevelop, &misfit),
        };
        let blocked = robot.blocked_plates();
        if let (true, Some((plate, other))) = (self.rules.plate_blocked, blocked.first()) {
            let names = [plate, other].map(|&m| &robot.modules()[m].name);
            let seen = format!("the plate of {} hits {}", names[0], names[1]);
            return fail(Reason::PlateBlocked, &seen);
        }
        let settling = settle(&self.experiment(&robot))?;
        for warning in settling.warnings() {
            let reason = match warning.code {
                Code::Diverged => Reason::Diverged,
                Code::Toppled => Reason::Toppled,
                _ => Reason::NotSettled,
            };
            if self.rules.unstable || reason == Reason::Diverged {
                return fail(reason, &warning.message);
            }
        }
        Ok(Ok(robot))
    }

    /// Repeats of one robot, in other solver settings where these are given. Only the first where that fails.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn repeats_of(
        &self,
        robot: &Morphology,
        seed: u64,
        repeats: usize,
        solver: Option<fn(&mut Solver)>,
    ) -> Result<Vec<Outcome>> {
        let base = self.experiment(robot);
        let one = |number: usize| {
            let mut experiment = self.repeat(&base, seed, number as u64)?;
            if let Some(change) = solver {
                change(&mut experiment.solver);
            }
            self.observe(&experiment)
        };
        let first = one(0)?;
        if first.status != OutcomeStatus::Completed {
            return Ok(vec![first]);
        }
        let rest: Result<Vec<Outcome>> = (1..repeats).into_par_iter().map(one).collect();
        Ok(std::iter::once(first).chain(rest?).collect())
    }

    /// One run, watched for what no robot can do.
    fn observe(&self, experiment: &Experiment) -> Result<Outcome> {
        let assembly = &experiment.assembly;
        let body_length_m = assembly.body_length_m;
        let posture = Posture::new(assembly);
        let floor: &Floor = &experiment.floor;
        let (mut step, mut highest_m, mut deepest_m) = (0_usize, 0.0_f64, 0.0_f64);
        let run = watch(experiment, &[], &mut |snapshot| {
            if step.is_multiple_of(LOOK_EVERY_STEPS) {
                highest_m = highest_m.max(posture.clearance_m(snapshot, floor));
                deepest_m = deepest_m.max(posture.overlap_m(snapshot));
            }
            step += 1;
        })?;
        let (high, deep) = (highest_m / body_length_m, deepest_m / body_length_m);
        let failure = match &run.outcome {
            simulation::Outcome::Diverged(divergence) => {
                Failure::new(Reason::Diverged, divergence.to_string())
            }
            _ if high > self.rules.flight_body_lengths => Failure::new(
                Reason::Flying,
                format!("{high:.3} body lengths above the floor"),
            ),
            _ if deep > self.rules.overlap_body_lengths => Failure::new(
                Reason::SelfPenetrating,
                format!("parts are {deep:.3} body lengths inside each other"),
            ),
            simulation::Outcome::Completed(motion) => {
                let path = prepare(motion)?;
                return Ok(Outcome {
                    status: OutcomeStatus::Completed,
                    steps: run.steps,
                    net_displacement_m: path.net_displacement_m(),
                    scores: vec![path.path_length_m(), motion.turned_rad().unwrap_or(0.0)],
                    path_xy_m: Vec::new(),
                });
            }
        };
        let mut outcome = failed(&failure);
        outcome.steps = run.steps;
        Ok(outcome)
    }

    /// What a stored trial is worth.
    ///
    /// # Errors
    /// A trial that this search cannot have stored.
    pub fn judge(&self, trial: &Trial) -> Result<Judged> {
        let torn =
            || Error::conflict("the store holds something else than robots").found(trial.index);
        let genes = trial.values.as_chunks::<{ Gene::LEN }>().0.to_vec();
        let genome = Genome::try_from(genes).map_err(|_| torn())?;
        let mut judged = Judged {
            index: trial.index,
            genome,
            fitness: None,
            failure: None,
            mean_displacement_m: None,
            descriptors: Vec::new(),
        };
        let body_length_m = self.body_length_m();
        let distances = match distances(&trial.outcomes) {
            Ok(distances) => distances,
            Err(failure) => {
                judged.failure = Some(failure);
                return Ok(judged);
            }
        };
        let measure = self.objective.measure;
        let values: Vec<f64> = distances
            .iter()
            .map(|d| measure.of(d, body_length_m, self.duration_s))
            .collect();
        let displacements: Vec<f64> = distances.iter().map(|d| d.displacement_m).collect();
        judged.fitness = Some(self.objective.aggregate.of(&values));
        judged.mean_displacement_m = Some(crate::statistics::mean(&displacements));
        if let Plan::MapElites(archive) = &self.plan {
            let name = self.robot_name(trial.index);
            let robot = self
                .body
                .build(&name, &judged.genome)
                .map_err(Error::from)?;
            let turned = trial.outcomes.iter().map(|o| o.scores.get(1).copied());
            let turned: Option<Vec<f64>> = turned.collect();
            let behaviour = Behaviour {
                robot: &robot,
                distances: &distances,
                turned_rad: &turned.ok_or_else(torn)?,
                body_length_m,
            };
            for axis in &archive.axes {
                let descriptor = descriptor_named(&axis.name)?;
                judged.descriptors.push(descriptor.of(&behaviour));
            }
        }
        Ok(judged)
    }

    /// Edge length of the modules, metres.
    pub fn body_length_m(&self) -> f64 {
        match &self.body {
            Body::Developed(development) => development.side_m,
            Body::Fixed(robot, _) => robot.summary().body_length_m,
        }
    }
}

/// How far each repeat got, or the first failure.
pub(super) fn distances(outcomes: &[Outcome]) -> std::result::Result<Vec<Distance>, Failure> {
    outcomes
        .iter()
        .map(|outcome| match &outcome.status {
            OutcomeStatus::Diverged(text) => Err(Failure::parse(text)),
            OutcomeStatus::Completed => Ok(Distance {
                displacement_m: outcome.net_displacement_m,
                path_length_m: outcome.scores.first().copied().unwrap_or(f64::NAN),
            }),
        })
        .collect()
}

fn failed(failure: &Failure) -> Outcome {
    Outcome {
        status: OutcomeStatus::Diverged(failure.to_string()),
        steps: 0,
        net_displacement_m: f64::NAN,
        scores: Vec::new(),
        path_xy_m: Vec::new(),
    }
}
