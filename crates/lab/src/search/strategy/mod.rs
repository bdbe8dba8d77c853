//! Strategies: the next robots to try, as a pure function of the history.
//!
//! A [`Strategy`] sees genomes, fitness and descriptors, never a simulator: the caller evaluates its proposals and passes the
//! history back. Adding one is one file and one line in `registry.rs`; `tests/strategy_contract.rs` checks the same contract for
//! all of them.

mod archive;
mod cma_es;
mod evolution;
mod generator;
mod grid;
mod map_elites;
mod operator;
mod registry;
mod selection;
mod space;
mod variation;

use std::fmt;

use serde::{Deserialize, Serialize};

use realgap_core::{Error, Result};
use realgap_robot::genome::Genome;

pub use archive::{Archive, Axis};
pub use cma_es::{CmaEs, CmaEsSettings};
pub use evolution::Evolution;
pub use generator::generator;
pub use grid::{GeneValues, Grid, GridSettings};
pub use map_elites::MapElites;
pub use operator::{OPERATORS, Operator, VariationParams, operator_named};
pub use registry::STRATEGIES;
pub(super) use registry::StrategyFile;
pub use selection::{SELECTIONS, Selection, selection_named};
pub use space::Space;
pub(super) use space::within;
pub use variation::Variation;

/// A genome with its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluated {
    /// The genome.
    pub genome: Genome,
    /// Fitness, larger is better; `None` for a failure (did not develop, diverged, flew).
    pub fitness: Option<f64>,
    /// Behaviour descriptors, in the order of [`Strategy::descriptors`].
    pub descriptors: Vec<f64>,
}

impl Evaluated {
    /// Fitness as it is compared: a failure or NaN is negative infinity.
    pub fn comparable(&self) -> f64 {
        self.fitness
            .filter(|fitness| !fitness.is_nan())
            .unwrap_or(f64::NEG_INFINITY)
    }
}

/// A robot that is proposed, and its parents.
type Born = (Genome, Vec<usize>);

fn genomes(born: Vec<Born>) -> Vec<Genome> {
    born.into_iter().map(|(genome, _)| genome).collect()
}

fn parents(born: Vec<Born>) -> Vec<Vec<usize>> {
    born.into_iter().map(|(_, parents)| parents).collect()
}

/// Refuses a number of things that is 0.
fn must_not_be_0(field: &str, value: usize) -> Result<()> {
    if value > 0 {
        return Ok(());
    }
    Err(Error::invalid("must not be 0")
        .field(field)
        .found(value)
        .allowed("1 or more"))
}

/// Proposes genomes. Pure: the same history gives the same proposals, so that a search is resumed by replaying it.
pub trait Strategy: fmt::Debug + Send + Sync {
    /// Name in tables and pictures.
    fn name(&self) -> &'static str;

    /// Robots of the whole search.
    fn budget(&self) -> usize;

    /// The name of a batch of robots, for readers.
    fn batch_name(&self) -> &'static str {
        "batch"
    }

    /// Names of the descriptors that it needs of every robot, in the order of [`Evaluated::descriptors`].
    fn descriptors(&self) -> Vec<&str> {
        Vec::new()
    }

    /// Indices into the history of the parents of each robot that [`Strategy::propose`] proposes: two, one, or none for a random
    /// robot.
    ///
    /// # Errors
    /// As [`Strategy::propose`].
    fn parents(&self, history: &[Evaluated]) -> Result<Vec<Vec<usize>>> {
        Ok(vec![Vec::new(); self.propose(history)?.len()])
    }

    /// The archive of a history, for a strategy that keeps one.
    ///
    /// # Errors
    /// Settings that cannot be used.
    fn archive(&self, history: &[Evaluated]) -> Result<Option<Archive>> {
        let _ = history;
        Ok(None)
    }

    /// The rest of the current batch: the robots that are evaluated and added to the history, in this order, before the next
    /// call. Empty when the search is complete.
    ///
    /// # Errors
    /// Settings that cannot be used.
    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>>;
}

/// Settings of a strategy, as a file has them; together with the space of a search they make a strategy.
pub trait StrategySettings: fmt::Debug + Send + Sync {
    /// The strategy.
    ///
    /// # Errors
    /// Settings that cannot be used here; `field` starts with `strategy` or `start`.
    fn strategy(&self, space: &Space) -> Result<Box<dyn Strategy>>;
}
