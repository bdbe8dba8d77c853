//! The best robots, looked at again: other solver settings, and draws that the search has not seen.

use std::sync::atomic::{AtomicBool, Ordering};

use super::evaluate::{Judged, distances};
use super::file::Hunt;
use crate::prediction::ensemble::{self, Ensemble, Forecast};
use crate::prediction::{Card, Finals, Rerun, Success, SuccessRule};
use crate::robot::morphology::Morphology;
use crate::simulation::parameter::ParameterSet;
use crate::simulation::{JointKind, Solver};
use crate::statistics::mean;
use crate::store::Outcome;
use crate::warning::{Code, Warning};
use crate::{Advice, Error, Result};

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
    pub prediction: Forecast,
    /// The objective of these repeats: what the robot is ranked by. The search's own fitness is that of a winner and flatters; `None`
    /// where repeats diverged.
    pub fitness: Option<f64>,
    /// `None` where the run without noise goes nowhere.
    pub success: Option<Success>,
}

impl Finalist {
    /// Whether every rerun is within the tolerance.
    pub fn survives(&self) -> bool {
        self.reruns.iter().all(|rerun| rerun.survives)
    }

    /// The prediction card; `rank` counts from 1, survivors first.
    ///
    /// # Errors
    /// None for a finalist of this search.
    pub fn card(&self, hunt: &Hunt, rank: usize) -> Result<Card> {
        let name = self.robot.name();
        let mut card = Card::new(name, &self.ensemble, SuccessRule::HalfOfNoiseFree)?
            .with_parameters(&hunt.set)
            .with_noise_from(hunt.name.clone());
        card.finals = Some(Finals {
            rank,
            survives: self.survives(),
            objective: hunt.objective.label(),
            unit: hunt.objective.measure.unit(),
            search_fitness: self.judged.fitness,
            fitness: self.fitness,
            reruns: self.reruns.clone(),
        });
        Ok(card)
    }
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
        let prediction = Forecast::new(&ensemble)?;
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
        let success = Success::new(&ensemble, SuccessRule::HalfOfNoiseFree)?;
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
        .advise(Advice::Resume));
    }
    Ok(())
}
