//! The search itself: proposals are evaluated in parallel, in the strategy's order.

use super::{Evaluated, EvaluatedRobot, Outcome, Performance, Search, Strategy};
use realgap_core::{Error, Result};
use realgap_optimization::{Batch, Ending, RunOptions, drive};
use realgap_robot::genome::Genome;
use realgap_store::{Memory, Mode, Part, Place, RobotRow, Storage, Store};

/// The robots of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchResults {
    /// The robots stand in the strategy's order.
    pub robots: Vec<EvaluatedRobot>,
    /// For each robot the indices of its parents; empty for a random robot.
    pub parents: Vec<Vec<usize>>,
    /// Sizes of the strategy's batches, in order. In an interrupted search the last one may not be complete.
    pub batches: Vec<usize>,
    /// Whether the search is complete.
    pub ending: Ending,
}

impl SearchResults {
    /// The robot with the largest fitness, the earlier one of equals; `None` where every robot failed.
    pub fn best(&self) -> Option<&EvaluatedRobot> {
        let mut best: Option<(&EvaluatedRobot, f64)> = None;
        for robot in &self.robots {
            if let Some(fitness) = robot.fitness()
                && best.is_none_or(|(_, held)| fitness > held)
            {
                best = Some((robot, fitness));
            }
        }
        best.map(|(robot, _)| robot)
    }

    /// The batch of the robot with this index, counted from 0.
    pub fn batch_of(&self, index: usize) -> usize {
        let mut end = 0;
        let ended = self.batches.iter().take_while(|size| {
            end += **size;
            end <= index
        });
        ended.count()
    }

    /// The robot with this index and its ancestors, youngest first: of two parents always the first, from whose body and gait a
    /// child is made.
    pub fn lineage(&self, index: usize) -> Vec<usize> {
        let first_parent = |robot: &usize| self.parents.get(*robot)?.first().copied();
        std::iter::successors(Some(index), first_parent).collect()
    }

    /// The robots in the form that strategies get.
    pub fn history(&self) -> Vec<Evaluated> {
        self.robots.iter().map(EvaluatedRobot::evaluated).collect()
    }
}

impl Search {
    /// Searches in memory. The robots depend on the search alone, not on the options.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub fn run(&self, options: &RunOptions<'_>) -> Result<SearchResults> {
        follow(self.strategy(), &mut Memory::default(), options, |i, g| {
            self.evaluate_until_stopped(i, g, options)
        })
    }

    /// As [`Search::run`], with a fitness function of the caller (larger is better) of a robot's repeats.
    ///
    /// # Errors
    /// As [`Search::run`]; those of `fitness`, and a fitness that is not a finite number.
    pub fn run_for(
        &self,
        fitness: impl Fn(&Performance) -> Result<f64> + Sync,
        options: &RunOptions<'_>,
    ) -> Result<SearchResults> {
        follow(self.strategy(), &mut Memory::default(), options, |i, g| {
            let mut robot = self.evaluate_until_stopped(i, g, options)?;
            if let Outcome::Walked(performance) = &mut robot.outcome {
                let value = fitness(performance)?;
                if !value.is_finite() {
                    return Err(Error::invalid("the fitness is not a finite number").found(value));
                }
                performance.fitness = value;
            }
            Ok(robot)
        })
    }

    /// Searches into the store of a results folder, from which an interrupted search continues: the robots have the same bits as
    /// those of [`Search::run`], however often it was interrupted.
    ///
    /// # Errors
    /// As [`Search::run`]; a folder that cannot be used.
    pub fn run_in<'a>(
        &self,
        place: impl Into<Place<'a>>,
        mode: Mode,
        options: &RunOptions<'_>,
    ) -> Result<SearchResults> {
        let place = place.into();
        let mut store = self.open(place, mode)?;
        let results = follow(self.strategy(), &mut store, options, |i, g| {
            self.evaluate_until_stopped(i, g, options)
        })
        .map_err(|error| match error.file() {
            None => error.at_file(place.folder()),
            Some(_) => error,
        })?;
        if results.ending == Ending::Complete {
            store.complete()?;
        }
        Ok(results)
    }

    /// Simulates one worker's share of the current batch of robots and stops there. The ending is "interrupted" unless all shares
    /// are merged already.
    ///
    /// # Errors
    /// As [`Search::run_in`].
    pub(crate) fn run_part(
        &self,
        part: &mut Part<RobotRow>,
        options: &RunOptions<'_>,
    ) -> Result<Ending> {
        let results = follow(self.strategy(), part, options, |i, g| {
            self.evaluate_until_stopped(i, g, options)
        })?;
        Ok(results.ending)
    }

    fn open(&self, place: Place<'_>, mode: Mode) -> Result<Store<RobotRow>> {
        let expected = format!("{} robots", self.strategy.budget());
        let mut store = Store::open(place, &self.fingerprint(), mode, "search", &expected)?;
        store.describe([
            ("kind", "search".to_owned()),
            ("search", self.name.clone()),
            ("search text", self.text.clone()),
            ("strategy", self.strategy.name().to_owned()),
            ("objective", self.objective.label()),
            ("unit", self.objective.measure.unit().label().to_owned()),
            (
                "descriptors",
                serde_json::json!(self.strategy.descriptors()).to_string(),
            ),
        ])?;
        Ok(store)
    }
}

/// Evaluates what a strategy proposes, batch by batch, until it proposes nothing more.
fn follow(
    strategy: &dyn Strategy,
    storage: &mut impl Storage<RobotRow>,
    options: &RunOptions<'_>,
    evaluate: impl Fn(usize, &Genome) -> Result<EvaluatedRobot> + Sync,
) -> Result<SearchResults> {
    let total = strategy.budget();
    let mut results = SearchResults {
        robots: Vec::new(),
        parents: Vec::new(),
        batches: Vec::new(),
        ending: Ending::Complete,
    };
    let mut history: Vec<Evaluated> = Vec::new();
    let mut best: Option<f64> = None;
    loop {
        let genomes = strategy.propose(&history)?;
        if genomes.is_empty() {
            return Ok(results);
        }
        let offset = history.len();
        let parents = strategy.parents(&history)?;
        let batch = Batch::new(offset + genomes.len(), options);
        results.ending = drive(
            &batch,
            storage,
            |index| Ok(RobotRow::from(&evaluate(index, &genomes[index - offset])?)),
            |done| options.tell(done, total, best),
        )?;
        results.batches.push(genomes.len());
        for row in storage.rows_within(offset..offset + genomes.len())? {
            let robot = EvaluatedRobot::try_from(&row)?;
            let proposed = genomes.get(robot.index - offset);
            if !proposed.is_some_and(|proposed| robot.is_of(proposed)) {
                return Err(
                    Error::conflict("the stored robots are not those of this search")
                        .found(format!("robot {}", robot.index)),
                );
            }
            if let Some(fitness) = robot.fitness().filter(|fitness| !fitness.is_nan()) {
                best = Some(best.map_or(fitness, |held| held.max(fitness)));
            }
            history.push(robot.evaluated());
            let own = parents.get(robot.index - offset);
            results.parents.push(own.cloned().unwrap_or_default());
            results.robots.push(robot);
        }
        if results.ending == Ending::Interrupted {
            // An unfinished batch is not part of the history, because the strategy sees whole batches only.
            return Ok(results);
        }
        options.tell(history.len(), total, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::CmaEs;
    use realgap_robot::genome::{Gene, Locus};

    #[test]
    fn batches_are_those_that_the_strategy_proposed_also_after_a_restart_with_more_robots() {
        let base = Genome::new(vec![Gene::clamped([0.5; Gene::LEN])]).unwrap();
        let strategy = CmaEs {
            base,
            searched: vec![(0, Locus::Amplitude)],
            evaluations: 600,
            seed: 1,
        };
        // The function is smooth and its maximum is soon found, so the optimizer restarts with twice as many points.
        let evaluate = |index, genome: &Genome| {
            let fitness = -(genome.genes()[0].get(Locus::Amplitude) - 0.3).powi(2);
            Ok(EvaluatedRobot {
                index,
                genome: genome.clone(),
                outcome: Outcome::Walked(Performance {
                    fitness,
                    repeats: Vec::new(),
                    descriptors: Vec::new(),
                }),
            })
        };
        let options = RunOptions::default();
        let results = follow(&strategy, &mut Memory::default(), &options, evaluate).unwrap();
        assert_eq!(results.robots.len(), 600);

        let mut history = Vec::new();
        let mut sizes = Vec::new();
        loop {
            let proposed = strategy.propose(&history).unwrap();
            if proposed.is_empty() {
                break;
            }
            for _ in &proposed {
                assert_eq!(results.batch_of(history.len()), sizes.len(), "{sizes:?}");
                history.push(results.robots[history.len()].evaluated());
            }
            sizes.push(proposed.len());
        }
        assert_eq!(sizes, results.batches);
        let (first, largest) = (sizes[0], sizes.iter().copied().max().unwrap());
        assert!(largest >= 2 * first, "no restart: {sizes:?}");
    }
}
