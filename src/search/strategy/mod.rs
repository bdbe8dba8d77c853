//! Strategies: what to try next, as a pure function of what was tried.

mod evolution;
mod grid;
mod map_elites;
mod variation;

use serde::{Deserialize, Serialize};

use crate::Result;
use crate::robot::genome::Genome;

pub use evolution::Evolution;
pub use grid::{GeneValues, Grid};
pub use map_elites::{Archive, Axis, MapElites};
pub use variation::Variation;

/// A genome and how it did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluated {
    /// The genome.
    pub genome: Genome,
    /// Fitness, larger is better; `None` for a failure (did not develop, diverged, flew).
    pub fitness: Option<f64>,
    /// Behaviour descriptors, in the order of the archive's axes; may be empty where there is no archive.
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

/// Proposes genomes. Pure: the same history gives the same proposals, so that a search is resumed by replaying it.
pub trait Strategy: Sync {
    /// The rest of the batch under way: what is to be evaluated and added to the history, in this order, before the next
    /// call. Nothing when the search is complete.
    ///
    /// # Errors
    /// Settings that cannot be used.
    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>>;
}
