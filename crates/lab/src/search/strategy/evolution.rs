//! Generations of a population.

use serde::Deserialize;

use super::{
    Born, Evaluated, Space, Strategy, StrategySettings, Variation, generator, genomes,
    must_not_be_0, parents, selection_named, within,
};
use realgap_core::{Error, Result};
use realgap_robot::genome::Genome;

/// A population over generations: the elites stay, children of selected parents take the other places.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Evolution {
    /// Robots of one generation.
    pub population: usize,
    /// Generations, the first (random) one included.
    pub generations: usize,
    /// Number of the best robots that stay; they are not evaluated again.
    pub elites: usize,
    /// Name of the selection, one of the [`SELECTIONS`](crate::search::SELECTIONS).
    pub selection: String,
    /// How children are made.
    pub variation: Variation,
    /// Seed of every random choice; that of the search in place of it where the strategy is part of one.
    #[serde(skip)]
    pub seed: u64,
}

impl Default for Evolution {
    /// Ten generations of ten robots, as published; the other numbers are assumptions.
    fn default() -> Self {
        Self {
            population: 10,
            generations: 10,
            elites: 2,
            selection: "tournament".to_owned(),
            variation: Variation::default(),
            seed: 1,
        }
    }
}

impl Evolution {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self) -> Result<()> {
        must_not_be_0("population", self.population)?;
        must_not_be_0("generations", self.generations)?;
        if self.elites >= self.population {
            return Err(Error::invalid("no place is left for children")
                .field("elites")
                .found(self.elites)
                .allowed(format!("0 to {}", self.population - 1)));
        }
        selection_named(&self.selection)?;
        self.variation.check()
    }

    /// Indices into the history of the population after so many complete generations, the fittest first; of equals the earlier
    /// one first.
    fn population_after(&self, generations: usize, history: &[Evaluated]) -> Vec<usize> {
        let children = self.population - self.elites;
        let mut population: Vec<usize> = (0..self.population).collect();
        let fittest_first = |population: &mut Vec<usize>| {
            population.sort_by(|&a, &b| {
                let (a, b) = (history[a].comparable(), history[b].comparable());
                b.total_cmp(&a)
            });
        };
        fittest_first(&mut population);
        for generation in 1..generations {
            population.truncate(self.elites);
            let from = self.population + (generation - 1) * children;
            population.extend(from..from + children);
            fittest_first(&mut population);
        }
        population
    }
}

impl StrategySettings for Evolution {
    fn strategy(&self, space: &Space) -> Result<Box<dyn Strategy>> {
        space.must_be_free()?;
        self.check().map_err(|e| within("strategy", e))?;
        space.must_hold(&self.variation)?;
        let seed = space.seed();
        Ok(Box::new(Self {
            seed,
            ..self.clone()
        }))
    }
}

impl Strategy for Evolution {
    realgap_core::constant_methods! {
        name: &'static str = "evolution";
        batch_name: &'static str = "generation";
    }

    fn budget(&self) -> usize {
        let children = self.population.saturating_sub(self.elites);
        let later = self.generations.saturating_sub(1).saturating_mul(children);
        self.population.saturating_add(later)
    }

    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        Ok(genomes(self.born(history)?))
    }

    fn parents(&self, history: &[Evaluated]) -> Result<Vec<Vec<usize>>> {
        Ok(parents(self.born(history)?))
    }
}

impl Evolution {
    fn born(&self, history: &[Evaluated]) -> Result<Vec<Born>> {
        self.check()?;
        if history.len() >= self.budget() {
            return Ok(Vec::new());
        }
        let children = self.population - self.elites;
        let (generation, done) = match history.len().checked_sub(self.population) {
            None => (0, history.len()),
            Some(later) => (1 + later / children, later % children),
        };
        let mut rng = generator(self.seed, generation as u64);
        // The whole generation is drawn again, so that the rest of it is the same as without an interruption.
        let mut batch = Vec::with_capacity(self.population);
        if generation == 0 {
            for _ in 0..self.population {
                batch.push((self.variation.random(&mut rng)?, Vec::new()));
            }
        } else {
            let population = self.population_after(generation, history);
            let fitness: Vec<f64> = population
                .iter()
                .map(|&index| history[index].comparable())
                .collect();
            let selection = selection_named(&self.selection)?;
            for _ in 0..children {
                let first = population[selection.pick(&fitness, &mut rng)];
                let second = population[selection.pick(&fitness, &mut rng)];
                let (one, other) = (&history[first].genome, &history[second].genome);
                let child = self.variation.child(one, other, &mut rng)?;
                batch.push((child, vec![first, second]));
            }
        }
        Ok(batch.split_off(done))
    }
}
