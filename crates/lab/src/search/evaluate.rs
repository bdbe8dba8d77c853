//! Evaluation of one robot: it is built, settled and repeated under noise, and its fitness is computed.

use rayon::prelude::*;

use super::{
    Behaviour, EvaluatedRobot, Failure, Measure, Objective, Outcome, Performance, Reason, Search,
    SettingsChoice, Travel, descriptor_named,
};
use realgap_core::{Code, Result};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::prepare;
use realgap_robot::genome::Genome;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Floor, Posture, settle, watch};

/// Steps between two looks at the body: flight and overlap last longer than that.
const LOOK_EVERY_STEPS: usize = 4;

/// Every repeat of a robot, or the first failure.
pub(super) type Repeats = std::result::Result<Vec<Travel>, Failure>;

impl Search {
    /// The experiment of one repeat of a robot: drawn parameters, then noise.
    ///
    /// # Errors
    /// None for a search that was built.
    pub fn repeat(&self, base: &Experiment, seed: u64, number: u64) -> Result<Experiment> {
        let drawn = self.uncertain.draw(seed, number)?.apply(base);
        Ok(self.noise.perturb(&drawn, seed, number))
    }

    /// Simulates one robot, with the gait that was tuned for it where the search tunes gaits. Repeat 0 goes first: a robot that
    /// fails there is not repeated. A robot that fails in any repeat has failed, so this saves time without changing any result.
    /// Uses the current rayon pool; the result does not depend on it.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn evaluate(&self, index: usize, genome: &Genome) -> Result<EvaluatedRobot> {
        self.evaluate_until_stopped(index, genome, &RunOptions::default())
    }

    /// As [`Search::evaluate`]; after a request to stop, the repeats of the unfinished robot are dropped.
    ///
    /// # Errors
    /// As [`Search::evaluate`]; interrupted.
    pub(super) fn evaluate_until_stopped(
        &self,
        index: usize,
        genome: &Genome,
        run: &RunOptions<'_>,
    ) -> Result<EvaluatedRobot> {
        let tuned = match &self.gait {
            None => Ok(genome.clone()),
            Some(tuning) => self.tuned(tuning, index, genome, run)?,
        };
        let (genome, outcome) = match tuned {
            Err(failure) => (genome.clone(), Outcome::Failed(failure)),
            Ok(genome) => {
                let outcome = self.judged(index, &genome, run)?;
                (genome, outcome)
            }
        };
        Ok(EvaluatedRobot {
            index,
            genome,
            outcome,
        })
    }

    fn judged(&self, index: usize, genome: &Genome, run: &RunOptions<'_>) -> Result<Outcome> {
        let robot = match self.build(index, genome)? {
            Err(failure) => return Ok(Outcome::Failed(failure)),
            Ok(robot) => robot,
        };
        Ok(
            match self.repeats_of(&robot, self.seed(), self.repeats, None, run)? {
                Err(failure) => Outcome::Failed(failure),
                Ok(repeats) => Outcome::Walked(self.performance(&robot, repeats)?),
            },
        )
    }

    fn performance(&self, robot: &Morphology, repeats: Vec<Travel>) -> Result<Performance> {
        let body_length_m = self.body().length_m();
        let behaviour = Behaviour {
            robot,
            repeats: &repeats,
            body_length_m,
        };
        let names = self.strategy.descriptors();
        let descriptors: Result<Vec<f64>> = names
            .iter()
            .map(|name| Ok(descriptor_named(name)?.of(&behaviour)))
            .collect();
        Ok(Performance {
            fitness: self.objective.of(&repeats, body_length_m, self.duration_s),
            descriptors: descriptors?,
            repeats,
        })
    }

    /// The robot of a genome, if it is worth simulating.
    pub(super) fn build(
        &self,
        index: usize,
        genome: &Genome,
    ) -> Result<std::result::Result<Morphology, Failure>> {
        let robot = match self.unblocked(index, genome) {
            Ok(robot) => robot,
            Err(failure) => return Ok(Err(failure)),
        };
        let settling = settle(&self.exploring(&robot))?;
        for warning in settling.warnings() {
            let reason = match warning.code {
                Code::Diverged => Reason::Diverged,
                Code::Toppled => Reason::Toppled,
                _ => Reason::NotSettled,
            };
            if self.failures.unstable || reason == Reason::Diverged {
                return Ok(Err(Failure::new(reason, &warning.message)));
            }
        }
        Ok(Ok(robot))
    }

    /// The robot of a genome, if none of its parts blocks another.
    pub(super) fn unblocked(
        &self,
        index: usize,
        genome: &Genome,
    ) -> std::result::Result<Morphology, Failure> {
        let robot = self.body().build(&self.robot_name(index), genome);
        let robot = robot.map_err(|misfit| Failure::new(Reason::DoesNotDevelop, misfit))?;
        let blocked = robot.blocked_plates();
        if let (true, Some((plate, other))) = (self.failures.plate_blocked, blocked.first()) {
            let names = [plate, other].map(|&m| &robot.modules()[m].name);
            let seen = format!("the plate of {} hits {}", names[0], names[1]);
            return Err(Failure::new(Reason::PlateBlocked, seen));
        }
        Ok(robot)
    }

    /// Repeats of one robot, with the settings of exploring or judging; the failure of the first repeat that fails.
    ///
    /// # Errors
    /// Settings that cannot be simulated; interrupted.
    pub(super) fn repeats_of(
        &self,
        robot: &Morphology,
        seed: u64,
        repeats: usize,
        change: Option<fn(&mut Experiment)>,
        run: &RunOptions<'_>,
    ) -> Result<Repeats> {
        let base = match change {
            None => self.exploring(robot),
            Some(_) => self.experiment(robot),
        };
        let one = |number: usize| {
            run.go_on()?;
            let mut experiment = self.repeat(&base, seed, number as u64)?;
            if change.is_none() && self.settings == SettingsChoice::EquallyValid {
                experiment = self.equally_valid(&experiment, number as u64);
            }
            if let Some(change) = change {
                change(&mut experiment);
            }
            if self.objective.measure == Measure::SpeedPerEnergy {
                experiment.energy_from_s = Some(self.objective.from_s);
            }
            self.observe(&experiment, &self.objective)
        };
        let first = match one(0)? {
            Ok(first) => first,
            Err(failure) => return Ok(Err(failure)),
        };
        let rest: Result<Vec<_>> = (1..repeats).into_par_iter().map(one).collect();
        Ok(std::iter::once(Ok(first)).chain(rest?).collect())
    }

    /// The repeat with this number in its own one of the equally valid settings: the engines take turns, and each has other steps
    /// in turn.
    fn equally_valid(&self, repeat: &Experiment, number: u64) -> Experiment {
        let mut repeat = repeat.clone();
        let engines = if self.explorer().is_some() { 2 } else { 1 };
        if number % engines == 1 {
            repeat.solver.engine = self.judge().solver.engine;
        }
        repeat.with_numerics(number / engines)
    }

    /// The part of one run that this objective uses. The run is watched for motions that no real robot can make.
    pub(super) fn observe(
        &self,
        experiment: &Experiment,
        objective: &Objective,
    ) -> Result<std::result::Result<Travel, Failure>> {
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
            realgap_simulation::Outcome::Diverged(divergence) => {
                Failure::new(Reason::Diverged, divergence.to_string())
            }
            _ if high > self.failures.flight_body_lengths => Failure::new(
                Reason::Flying,
                format!("{high:.3} body lengths above the floor"),
            ),
            _ if deep > self.failures.overlap_body_lengths => Failure::new(
                Reason::SelfPenetrating,
                format!("parts are {deep:.3} body lengths inside each other"),
            ),
            realgap_simulation::Outcome::Completed(motion) => {
                let path = prepare(motion)?;
                let turned_rad = motion.turned_rad().unwrap_or(0.0);
                return Ok(Ok(objective.travel(
                    &path,
                    turned_rad,
                    run.energy.as_ref(),
                    experiment.duration_s,
                )));
            }
        };
        Ok(Err(failure))
    }
}
