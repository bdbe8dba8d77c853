//! The search for the best robot: where strategies meet the simulator.
//!
//! [`Hunt::read`] parses a search file, [`search()`] lets its strategy propose robots and evaluates them under noise into the store, and
//! [`Hunt::finalists`] looks at the best again. Strategies ([`Strategy`]) see genomes and fitness only; what is
//! made large is an [`Objective`] over repeats that differ by noise and by what tuning left open ([`Doubt`]).
//!
//! ```
//! use realgap::file::Source;
//! use realgap::search::{Hunt, Wishes};
//!
//! let text = r#"Search(
//!     strategy: Evolution(population: 10, generations: 10),
//!     duration_s: 20.0,
//!     objective: (measure: Displacement, aggregate: LowerQuantile(0.2)),
//!     parameters: [(name: "floor.friction", low: 0.3, high: 0.5)],
//! )"#;
//! let hunt = Hunt::parse(&Source::new("best.ron", text), &Wishes::default())?;
//! assert_eq!((hunt.plan.name(), hunt.plan.budget(), hunt.repeats), ("evolution", 82, 8));
//! # Ok::<(), realgap::Error>(())
//! ```
//!
//! # The file
//!
//! | field | meaning | default |
//! |---|---|---|
//! | `strategy` | `Evolution(population, generations, elites, selection, variation)`, `MapElites(axes, initial, batch, evaluations, variation)`, `Grid(genes)` or `CmaEs(evaluations, genes)` | |
//! | `start` | of `Grid` and `CmaEs`: `Genome("file.ron")`, or `Morphology("file.ron")` for its gait alone | |
//! | `duration_s` | length of each run | |
//! | `development` | settings of [`Development`](crate::robot::genome::Development); of a genome file its own | |
//! | `set` | fixed parameters, `{"floor.friction": 0.4}` | |
//! | `parameters` | what is only known to a range, `[(name, low, high)]`: every repeat draws | |
//! | `indistinguishable` | a folder of `sweep` or `tune`: every repeat gets one of the points that cannot be told from its best | |
//! | `noise` | as in a study | an estimate |
//! | `objective` | `(measure: Displacement, Straightness or Speed; aggregate: Mean, LowerQuantile(level) or MeanMinusSd(k))` | displacement, 20 % quantile |
//! | `repeats` | runs of every robot; all robots get the same draws | 8 |
//! | `failures` | [`Rules`] | |
//! | `finalists` | [`Finals`] | |
//! | `seed` | of everything random | 1 |
//!
//! # Strategies alone
//!
//! [`OPERATORS`] vary genomes, [`SELECTIONS`] pick their parents, and a [`Strategy`] proposes what to try next. None of these
//! knows a simulator: who searches evaluates the proposals and hands the history back.
//!
//! ```
//! use realgap::robot::genome::Genome;
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

mod body;
mod brain;
mod descriptor;
mod doubt;
mod evaluate;
mod failure;
mod file;
mod finalist;
mod generator;
mod objective;
mod operator;
mod plan;
mod run;
mod selection;
mod strategy;

pub use crate::store::Mode;
pub use body::Body;
pub use brain::CmaEs;
pub use descriptor::{Behaviour, DESCRIPTORS, Descriptor, descriptor_named};
pub use doubt::{Doubt, INDISTINGUISHABLE_FILE, Uncertain, read_indistinguishable};
pub use evaluate::Judged;
pub use failure::{Failure, Reason, Rules};
pub use file::{Finals, Hunt, Wishes};
pub use finalist::Finalist;
pub use generator::generator;
pub use objective::{Aggregate, Distance, Measure, Objective};
pub use operator::{Dose, OPERATORS, Operator, operator_named};
pub use plan::Plan;
pub use run::{Outing, Quarry, search};
pub use selection::{SELECTIONS, Selection, selection_named};
pub use strategy::{
    Archive, Axis, Evaluated, Evolution, GeneValues, Grid, MapElites, Strategy, Variation,
};
