//! Finals: the best robots are judged again, with other solver settings and with random draws that the search has not used.

use super::evaluate::Repeats;
use super::robot::mean_displacement_m;
use super::{Evaluated, EvaluatedRobot, Search, SearchResults, Travel};
use crate::prediction::ensemble::{self, Draws, Ensemble, Forecast};
use crate::prediction::{
    Card, CostOfTransport, DivergenceRate, Finals, Rerun, Success, SuccessRule,
};
use realgap_core::{Error, Result};
use realgap_optimization::{RunOptions, pool};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{EnergyBalance, Experiment};

/// Name of the engine that judges, where another one explored.
const JUDGE: &str = "judging engine";

/// The limits cost more than all other reruns together, so only robots that survive these are run there.
const LIMITS: [&str; 2] = ["limit of hard contact", "other joint kind at its limit"];

/// A change of the settings.
type Change = fn(&mut Experiment);

/// Other settings under which a robot must walk the same, each with a name; all are in the engine that judges.
const RERUNS: [(&str, Change); 7] = [
    (JUDGE, |_| ()),
    ("half timestep", |e| e.solver.timestep_s *= 0.5),
    ("double timestep", |e| e.solver.timestep_s *= 2.0),
    ("half substeps", |e| {
        e.solver.substeps = (e.solver.substeps / 2).max(1);
    }),
    ("double substeps", |e| e.solver.substeps *= 2),
    // Convergence in the timestep alone does not prove a result correct: a contact that is too soft converges as well, to
    // something else.
    (LIMITS[0], |e| *e = e.at_limit(e.joint_kind())),
    (LIMITS[1], |e| {
        *e = e.at_limit(e.joint_kind().other());
    }),
];

/// One of the best robots.
#[derive(Debug, Clone)]
pub struct Finalist {
    /// This is the robot as the search saw it.
    pub evaluated: EvaluatedRobot,
    /// The robot.
    pub robot: Morphology,
    /// Repeats with fresh seeds.
    pub ensemble: Ensemble,
    /// Its rank, and how it did under other settings.
    pub finals: Finals,
    /// The prediction card of the repeats.
    prediction: Card,
}

impl Finalist {
    /// The forecast of the repeats.
    pub fn prediction(&self) -> &Forecast {
        &self.prediction.prediction
    }

    /// The probability that it moves far enough; `None` where the run without noise goes nowhere.
    pub fn success(&self) -> Option<&Success> {
        self.prediction.success.as_ref()
    }

    /// The finalist with a result from elsewhere, e.g. from another simulator, which also decides whether it survives.
    #[must_use]
    pub fn with_rerun(mut self, rerun: Rerun) -> Self {
        self.finals.survives &= rerun.survives;
        self.finals.reruns.push(rerun);
        self
    }

    /// The prediction card.
    pub fn card(&self) -> Card {
        Card {
            finals: Some(self.finals.clone()),
            ..self.prediction.clone()
        }
    }
}

impl Search {
    /// Seed of the finalists' repeats: draws that the search has not seen.
    pub fn finals_seed(&self) -> u64 {
        self.seed().wrapping_add(1 << 32)
    }

    /// The best different robots, best first. Where the strategy keeps an archive they are of different cells, so that a flaw of
    /// one kind of robot does not affect all of them.
    fn best(&self, robots: &[EvaluatedRobot]) -> Result<Vec<(EvaluatedRobot, Morphology)>> {
        let history: Vec<Evaluated> = robots.iter().map(EvaluatedRobot::evaluated).collect();
        let mut order: Vec<&EvaluatedRobot> = match self.strategy.archive(&history)? {
            Some(archive) => {
                let elites = archive.elites().into_iter();
                elites.map(|(_, elite)| &robots[elite]).collect()
            }
            None => robots.iter().filter(|r| r.fitness().is_some()).collect(),
        };
        // The sort is stable: of equals, the earlier one comes first.
        order.sort_by(|a, b| {
            let [a, b] = [a, b].map(|r| r.fitness().unwrap_or(f64::NEG_INFINITY));
            b.total_cmp(&a)
        });
        let mut best: Vec<(EvaluatedRobot, Morphology)> = Vec::new();
        for evaluated in order {
            if best.len() == self.finals.count {
                break;
            }
            let name = self.robot_name(evaluated.index);
            let robot = self.body().build(&name, &evaluated.genome)?;
            // Other genomes may give the same robot, or one that does not differ in any part that acts.
            let is_new = best.iter().all(|(before, known)| {
                let is_built_alike = known.modules() == robot.modules()
                    && known.attachments() == robot.attachments();
                !is_built_alike && !before.walked_as(evaluated)
            });
            if is_new {
                best.push((evaluated.clone(), robot));
            }
        }
        Ok(best)
    }

    /// Judges the best robots again and ranks them: survivors of the reruns first, by the fitness with fresh seeds. The progress is
    /// that of the finalists.
    ///
    /// # Errors
    /// Interrupted; settings that cannot be simulated.
    pub fn finalists(
        &self,
        results: &SearchResults,
        options: &RunOptions<'_>,
    ) -> Result<Vec<Finalist>> {
        pool(options.jobs)?.install(|| self.look_again(&results.robots, options))
    }

    fn look_again(
        &self,
        robots: &[EvaluatedRobot],
        options: &RunOptions<'_>,
    ) -> Result<Vec<Finalist>> {
        let best = self.best(robots)?;
        let count = best.len();
        let mut finalists = Vec::new();
        for (evaluated, robot) in best {
            let mut reruns = Vec::new();
            for (settings, change) in RERUNS {
                let is_lost = !reruns.iter().all(|rerun: &Rerun| rerun.survives);
                if settings == JUDGE && self.explorer().is_none()
                    || is_lost && LIMITS.contains(&settings)
                {
                    continue;
                }
                stopped(options)?;
                let (seed, repeats) = (self.seed(), self.repeats);
                let again = self.repeats_of(&robot, seed, repeats, Some(change), options)?;
                reruns.push(self.rerun(settings, &evaluated, &again));
            }
            let finalist = self.predict(evaluated, robot, reruns, options)?;
            stopped(options)?;
            finalists.push(finalist);
            options.tell(finalists.len(), count, None);
        }
        Ok(rank(finalists))
    }

    fn rerun(&self, settings: &'static str, evaluated: &EvaluatedRobot, again: &Repeats) -> Rerun {
        match again {
            Err(failure) => Rerun {
                settings,
                mean_displacement_m: None,
                change: None,
                failure: Some(failure.to_string()),
                survives: false,
            },
            Ok(repeats) => {
                let now_m = mean_displacement_m(repeats);
                let change = evaluated
                    .mean_displacement_m()
                    .map(|before_m| (now_m - before_m) / before_m);
                Rerun {
                    settings,
                    mean_displacement_m: Some(now_m),
                    change,
                    failure: None,
                    survives: change.is_some_and(|c| c.abs() <= self.finals.tolerance),
                }
            }
        }
    }

    fn predict(
        &self,
        evaluated: EvaluatedRobot,
        robot: Morphology,
        reruns: Vec<Rerun>,
        options: &RunOptions<'_>,
    ) -> Result<Finalist> {
        let ensemble = self.repeat_again(&robot, options)?;
        let finals = Finals {
            // The rank is known once all finalists are judged.
            rank: 0,
            survives: reruns.iter().all(|rerun| rerun.survives),
            objective: self.objective.label(),
            unit: self.objective.measure.unit(),
            search_fitness: evaluated.fitness(),
            fitness: self.fitness_of(&ensemble),
            economy: self.economy_of(&robot, &ensemble),
            reruns,
        };
        let prediction = Card::new(robot.name(), &ensemble, SuccessRule::HalfOfNoiseFree)?
            .with_parameters(&self.set)
            .with_noise_from(&self.noise_from)
            .with_growth(DivergenceRate::of(&self.experiment(&robot))?);
        Ok(Finalist {
            evaluated,
            robot,
            ensemble,
            finals,
            prediction,
        })
    }

    /// Repeats of a robot with draws that the search has not used.
    pub(super) fn repeat_again(
        &self,
        robot: &Morphology,
        options: &RunOptions<'_>,
    ) -> Result<Ensemble> {
        let mut base = self.experiment(robot);
        base.energy_from_s = Some(self.objective.from_s);
        let seed = self.finals_seed();
        let draws = Draws {
            // Camera noise is left out, because the motion of the robot counts and not its recording.
            noise: &self.noise.without_camera(),
            uncertain: &self.uncertain,
            seed,
            repeats: self.finals.repeats,
            recall: &|_| Ok(None),
        };
        let quiet = RunOptions {
            progress: None,
            ..*options
        };
        ensemble::run_each(&base, &draws, &quiet)
    }

    /// The part of every completed repeat that the objective uses.
    fn travels<'a>(&'a self, ensemble: &'a Ensemble) -> impl Iterator<Item = Travel> + 'a {
        ensemble.motions().map(|(_, motion)| {
            let energy = motion.energy.as_ref();
            self.objective
                .travel(&motion.path, motion.turned_rad, energy, self.duration_s)
        })
    }

    /// Cost of transport; `None` where the servos gave no energy or the robot moved nowhere.
    fn economy_of(&self, robot: &Morphology, ensemble: &Ensemble) -> Option<CostOfTransport> {
        let weight_n = robot.summary().mass_kg * self.experiment(robot).gravity_m_s2;
        let travels: Vec<Travel> = self.travels(ensemble).collect();
        let servos_j = travels.iter().map(|travel| travel.servo_j);
        let distances_m = travels.iter().map(|travel| travel.displacement_m);
        let balances = ensemble
            .motions()
            .filter_map(|(_, motion)| motion.energy.as_ref());
        CostOfTransport::new(
            &servos_j.collect::<Option<Vec<f64>>>()?,
            &distances_m.collect::<Vec<f64>>(),
            weight_n,
            balances.map(EnergyBalance::residual_share),
        )
    }

    /// The objective of an ensemble; `None` where a repeat diverged.
    pub(super) fn fitness_of(&self, ensemble: &Ensemble) -> Option<f64> {
        let repeats: Vec<Travel> = self.travels(ensemble).collect();
        let all_walked = repeats.len() == ensemble.repeats.len() && !repeats.is_empty();
        let body_length_m = self.body().length_m();
        all_walked.then(|| self.objective.of(&repeats, body_length_m, self.duration_s))
    }
}

/// Ranks finalists: survivors of every rerun first, by the fitness with fresh seeds. The seeds with which a robot was chosen
/// do not count.
pub fn rank(mut finalists: Vec<Finalist>) -> Vec<Finalist> {
    finalists.sort_by(|a, b| {
        let key = |f: &Finalist| f.finals.fitness.unwrap_or(f64::NEG_INFINITY);
        let survives = |f: &Finalist| f.finals.survives;
        (survives(b).cmp(&survives(a))).then(key(b).total_cmp(&key(a)))
    });
    for (index, finalist) in finalists.iter_mut().enumerate() {
        finalist.finals.rank = index + 1;
    }
    finalists
}

fn stopped(options: &RunOptions<'_>) -> Result<()> {
    if options.is_stopped() {
        return Err(Error::interrupted(
            "interrupted while the best robots were looked at again",
        ));
    }
    Ok(())
}
