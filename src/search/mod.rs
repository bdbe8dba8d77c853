//! Search for a robot: how new genomes come from old ones.
//!
//! [`OPERATORS`] vary genomes, [`SELECTIONS`] pick their parents, and a [`Strategy`] proposes what to try next. Nothing here
//! knows a simulator: who searches evaluates the proposals and hands the history back.
//!
//! ```
//! use realgap::genome::Genome;
//! use realgap::search::{Evaluated, Evolution, Strategy, generator};
//!
//! // As much amplitude as possible, without any physics.
//! let strategy = Evolution { generations: 5, ..Evolution::default() };
//! let mut history: Vec<Evaluated> = Vec::new();
//! loop {
//!     let proposed = strategy.propose(&history)?;
//!     if proposed.is_empty() {
//!         break;
//!     }
//!     history.extend(proposed.into_iter().map(|genome: Genome| {
//!         let fitness = genome.genes().iter().map(|gene| gene.values()[6]).sum();
//!         Evaluated { genome, fitness: Some(fitness), descriptors: Vec::new() }
//!     }));
//! }
//! let best = history.iter().map(Evaluated::comparable).fold(f64::NEG_INFINITY, f64::max);
//! let first = history[..10].iter().map(Evaluated::comparable).fold(f64::NEG_INFINITY, f64::max);
//! assert!(best > first);
//! # Ok::<(), realgap::Error>(())
//! ```

mod generator;
mod operator;
mod selection;
mod strategy;

pub use generator::generator;
pub use operator::{Dose, OPERATORS, Operator, operator_named};
pub use selection::{SELECTIONS, Selection, selection_named};
pub use strategy::{
    Archive, Axis, Evaluated, Evolution, GeneValues, Grid, MapElites, Strategy, Variation,
};

use crate::{Error, Result};

/// The entry of a registry that has this name.
fn by_name<T: ?Sized>(
    kind: &str,
    name: &str,
    all: &'static [&'static T],
    name_of: impl Fn(&T) -> &'static str,
) -> Result<&'static T> {
    all.iter()
        .copied()
        .find(|entry| name_of(entry) == name)
        .ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|entry| name_of(entry)).collect();
            Error::invalid(format!("unknown {kind}"))
                .found(name)
                .allowed(names.join(", "))
        })
}
