//! How a child is made of its parents: crossover, then mutations.

use rand::Rng;
use serde::{Deserialize, Serialize};

use super::{VariationParams, operator_named};
use realgap_core::{Error, Result};
use realgap_robot::genome::Genome;

/// Crossover and mutation of a strategy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Variation {
    /// Name of the crossover, one of the [`OPERATORS`](crate::search::OPERATORS).
    pub crossover: String,
    /// Probability of a crossover; otherwise the child starts as a copy of the first parent.
    pub crossover_rate: f64,
    /// Probability of a change of each number.
    pub mutation_rate: f64,
    /// Standard deviation of a change, as a share of the range.
    pub mutation_sd: f64,
    /// Probability each of adding, removing and duplicating a module.
    pub length_rate: f64,
    /// Most modules of a child.
    pub max_modules: usize,
}

impl Default for Variation {
    /// The rates are assumptions, because the papers do not publish theirs.
    fn default() -> Self {
        Self {
            crossover: "one-point".to_owned(),
            crossover_rate: 0.5,
            mutation_rate: 0.1,
            mutation_sd: 0.2,
            length_rate: 0.1,
            max_modules: 5,
        }
    }
}

impl Variation {
    /// Checks names and rates.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self) -> Result<()> {
        for (field, rate) in [
            ("crossover_rate", self.crossover_rate),
            ("mutation_rate", self.mutation_rate),
            ("length_rate", self.length_rate),
        ] {
            self.params(rate).check().map_err(|e| e.field(field))?;
        }
        if operator_named(&self.crossover)?.is_crossover() {
            return Ok(());
        }
        Err(Error::invalid("this operator is no crossover")
            .field("crossover")
            .found(&self.crossover))
    }

    fn params(&self, rate: f64) -> VariationParams {
        VariationParams {
            rate,
            standard_deviation: self.mutation_sd,
            max_modules: self.max_modules,
        }
    }

    /// One child.
    ///
    /// # Errors
    /// As [`Variation::check`].
    pub fn child(&self, first: &Genome, second: &Genome, rng: &mut dyn Rng) -> Result<Genome> {
        let crossover = operator_named(&self.crossover)?;
        let mut child = crossover.vary(first, second, &self.params(self.crossover_rate), rng);
        for (name, rate) in [
            ("add", self.length_rate),
            ("remove", self.length_rate),
            ("duplicate", self.length_rate),
            ("gaussian", self.mutation_rate),
        ] {
            child = operator_named(name)?.vary(&child, &child, &self.params(rate), rng);
        }
        Ok(child)
    }

    /// A random genome of 1 to `max_modules` modules, with evenly distributed numbers.
    ///
    /// # Errors
    /// As [`Variation::check`].
    pub fn random(&self, rng: &mut dyn Rng) -> Result<Genome> {
        use rand::RngExt as _;
        let modules = rng.random_range(1..=self.max_modules.max(1));
        Genome::random(modules, rng)
    }
}
