//! The best robots, looked at again: other solver settings, and draws that the search has not seen.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

use super::evaluate::{Judged, distances};
use super::file::Hunt;
use crate::prediction::ensemble::{self, Ensemble, Motion, Summary};
use crate::robot::morphology::Morphology;
use crate::simulation::parameter::ParameterSet;
use crate::simulation::{JointKind, Solver};
use crate::statistics::{Proportion, mean};
use crate::store::Outcome;
use crate::warning::{Code, Warning};
use crate::{Error, Result};

/// A change of the solver's settings.
type Change = fn(&mut Solver);

/// Other settings under which a robot must walk the same, with a name each.
const RERUNS: [(&str, Change); 5] = [
    ("half timestep", |s| s.timestep_s *= 0.5),
    ("double timestep", |s| s.timestep_s *= 2.0),
    ("half substeps", |s| s.substeps = (s.substeps / 2).max(1)),
    ("double substeps", |s| s.substeps *= 2),
    ("other joint kind", |s| {
        s.joint = match s.joint {
            JointKind::Impulse => JointKind::Multibody,
            JointKind::Multibody => JointKind::Impulse,
        }
    }),
];

/// A robot under other solver settings, with the draws of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rerun {
    /// What was changed.
    pub settings: &'static str,
    /// Mean net displacement, metres; `None` where it failed.
    pub mean_displacement_m: Option<f64>,
    /// Change of the mean displacement as a share of that of the search's own settings.
    pub change: Option<f64>,
    /// Why it failed.
    pub failure: Option<String>,
    /// Whether the change is within the tolerance.
    pub survives: bool,
}

/// How likely a robot gets far enough.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Success {
    /// Far enough, metres: half of what the run without noise does.
    pub least_displacement_m: f64,
    /// How likely.
    pub probability: Proportion,
}

/// One of the best robots.
#[derive(Debug, Clone)]
pub struct Finalist {
    /// As the search saw it.
    pub judged: Judged,
    /// The robot.
    pub robot: Morphology,
    /// The robot in other settings.
    pub reruns: Vec<Rerun>,
    /// Repeats with new draws.
    pub ensemble: Ensemble,
    /// What they say.
    pub prediction: Summary,
    /// The objective of these repeats: what the robot is ranked by. The search's own fitness is that of a winner and flatters; `None`
    /// where repeats diverged.
    pub fitness: Option<f64>,
    /// `None` where the run without noise goes nowhere.
    pub success: Option<Success>,
}

/// The prediction card of a finalist, as it is written.
#[derive(Debug, Serialize)]
pub struct Card<'a> {
    /// The robot's name.
    pub robot: &'a str,
    /// From 1; survivors first.
    pub rank: usize,
    /// Whether every rerun is within the tolerance.
    pub survives: bool,
    /// What was searched for.
    pub objective: String,
    /// Unit of both fitnesses.
    pub unit: &'static str,
    /// With the draws of the search.
    pub search_fitness: Option<f64>,
    /// With new draws.
    pub fitness: Option<f64>,
    /// The robot in other settings.
    pub reruns: &'a [Rerun],
    /// How likely it gets far enough.
    pub success: Option<&'a Success>,
    /// Fixed values of parameters.
    pub parameters: BTreeMap<String, f64>,
    /// The engine and its precision.
    pub engine: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// What the repeats say.
    pub prediction: &'a Summary,
}

/// A robot that gets less far than this share of its body length without noise goes nowhere.
const NOWHERE_BODY_LENGTHS: f64 = 0.1;

impl Finalist {
    /// Whether every rerun is within the tolerance.
    pub fn survives(&self) -> bool {
        self.reruns.iter().all(|rerun| rerun.survives)
    }

    /// What is written beside the robot.
    pub fn card(&self, hunt: &Hunt, rank: usize) -> Card<'_> {
        Card {
            robot: self.robot.name(),
            rank,
            survives: self.survives(),
            objective: hunt.objective.label(),
            unit: hunt.objective.measure.unit().label(),
            search_fitness: self.judged.fitness,
            fitness: self.fitness,
            reruns: &self.reruns,
            success: self.success.as_ref(),
            parameters: values(&hunt.set),
            engine: crate::simulation::ENGINE_VERSION,
            version: env!("CARGO_PKG_VERSION"),
            prediction: &self.prediction,
        }
    }
}

fn values(set: &ParameterSet) -> BTreeMap<String, f64> {
    set.iter()
        .map(|a| (a.parameter.name.to_owned(), a.value))
        .collect()
}

impl Hunt {
    /// Seed of the finalists' repeats: draws that the search has not seen.
    pub fn finals_seed(&self) -> u64 {
        self.seed.wrapping_add(1 << 32)
    }

    /// The best different robots, best first.
    ///
    /// # Errors
    /// None for robots of this search.
    pub fn best(&self, robots: &[Judged]) -> Result<Vec<(Judged, Morphology)>> {
        let mut order: Vec<&Judged> = robots.iter().filter(|r| r.fitness.is_some()).collect();
        // Stable: of equals the earlier.
        order.sort_by(|a, b| {
            let [a, b] = [a, b].map(|r| r.fitness.unwrap_or(f64::NEG_INFINITY));
            b.total_cmp(&a)
        });
        let mut best: Vec<(Judged, Morphology)> = Vec::new();
        for judged in order {
            if best.len() == self.finals.count {
                break;
            }
            let name = self.robot_name(judged.index);
            let robot = self
                .body
                .build(&name, &judged.genome)
                .map_err(Error::from)?;
            // Other genomes may mean the same robot.
            let is_new = best.iter().all(|(_, known)| {
                known.modules() != robot.modules() || known.glue() != robot.glue()
            });
            if is_new {
                best.push((judged.clone(), robot));
            }
        }
        Ok(best)
    }

    /// Looks at the best robots again and ranks them: survivors of the reruns first, by the fitness with new draws. `progress`
    /// hears how many are done. Uses the current rayon pool.
    ///
    /// # Errors
    /// Interrupted by `stop`; settings that cannot be simulated.
    pub fn finalists(
        &self,
        robots: &[Judged],
        stop: &AtomicBool,
        mut progress: impl FnMut(usize),
    ) -> Result<Vec<Finalist>> {
        let mut finalists = Vec::new();
        for (judged, robot) in self.best(robots)? {
            let mut reruns = Vec::new();
            for (settings, change) in RERUNS {
                stopped(stop)?;
                let outcomes = self.repeats_of(&robot, self.seed, self.repeats, Some(change))?;
                reruns.push(self.rerun(settings, &judged, &outcomes));
            }
            let finalist = self.predict(judged, robot, reruns, stop)?;
            stopped(stop)?;
            finalists.push(finalist);
            progress(finalists.len());
        }
        finalists.sort_by(|a, b| {
            let key = |f: &Finalist| f.fitness.unwrap_or(f64::NEG_INFINITY);
            (b.survives().cmp(&a.survives())).then(key(b).total_cmp(&key(a)))
        });
        Ok(finalists)
    }

    fn rerun(&self, settings: &'static str, judged: &Judged, outcomes: &[Outcome]) -> Rerun {
        match distances(outcomes) {
            Err(failure) => Rerun {
                settings,
                mean_displacement_m: None,
                change: None,
                failure: Some(failure.to_string()),
                survives: false,
            },
            Ok(distances) => {
                let far: Vec<f64> = distances.iter().map(|d| d.displacement_m).collect();
                let now_m = mean(&far);
                let change = judged
                    .mean_displacement_m
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
        judged: Judged,
        robot: Morphology,
        reruns: Vec<Rerun>,
        stop: &AtomicBool,
    ) -> Result<Finalist> {
        let base = self.experiment(&robot);
        let seed = self.finals_seed();
        // `run_each` takes no errors, and draws of a checked doubt have none.
        let drawn: Result<Vec<ParameterSet>> = (0..self.finals.repeats as u64)
            .map(|number| self.doubt.draw(seed, number))
            .collect();
        let drawn = drawn?;
        let mut ensemble = ensemble::run_each(
            &base,
            |number| drawn[number as usize].apply(&base),
            &self.noise,
            seed,
            self.finals.repeats,
            stop,
            |_| (),
        )?;
        if !self.doubt.is_none() {
            ensemble.warnings.push(Warning::new(
                Code::UncertainParameters,
                "repeats differ in the parameters that tuning left open, too; the run without noise has the fixed values",
            ));
        }
        let prediction = Summary::new(&ensemble)?;
        let (body_length_m, measure) = (self.body_length_m(), self.objective.measure);
        let values: Vec<f64> = ensemble
            .motions()
            .map(|(_, motion)| {
                let distance = super::objective::Distance {
                    displacement_m: motion.net_displacement_m(),
                    path_length_m: motion.path.path_length_m(),
                };
                measure.of(&distance, body_length_m, self.duration_s)
            })
            .collect();
        let all_walked = values.len() == ensemble.repeats.len() && !values.is_empty();
        let success = ensemble
            .noise_free
            .motion()
            .map(Motion::net_displacement_m)
            .filter(|far_m| *far_m >= NOWHERE_BODY_LENGTHS * ensemble.body_length_m)
            .map(|far_m| Success {
                least_displacement_m: 0.5 * far_m,
                probability: ensemble.success(0.5 * far_m),
            });
        Ok(Finalist {
            fitness: all_walked.then(|| self.objective.aggregate.of(&values)),
            judged,
            robot,
            reruns,
            prediction,
            ensemble,
            success,
        })
    }
}

fn stopped(stop: &AtomicBool) -> Result<()> {
    if stop.load(Ordering::Relaxed) {
        return Err(Error::interrupted(
            "interrupted while the best robots were looked at again; all robots are saved",
        )
        .hint("go on with --resume"));
    }
    Ok(())
}
