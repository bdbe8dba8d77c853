//! The search for the best robot: genomes, strategies, an objective under noise, finalists.
//!
//! [`Search::builder`] builds a search, [`Search::read`] reads one from a file. [`Search::run`] lets its [`Strategy`] propose robots and
//! evaluates them under noise, in memory; [`Search::run_in`] does the same into the store of a results folder.
//! [`Search::finalists`] judges the best robots again. Strategies see genomes and fitness only. The search maximises an
//! [`Objective`] over repeats, which differ by noise and by the values that tuning left open ([`UncertainParameters`]).
//!
//! ```
//! use realgap_optimization::RunOptions;
//! use realgap_lab::search::{Evolution, FinalsSettings, Search};
//!
//! let search = Search::builder(Evolution { population: 3, generations: 2, ..Evolution::default() })
//!     .uncertain("floor.friction", 0.3, 0.5)
//!     .duration_s(0.5)
//!     .repeats(2)
//!     .finals(FinalsSettings { count: 1, repeats: 4, ..FinalsSettings::default() })
//!     .build()?;
//! let options = RunOptions::default();
//! let results = search.run(&options)?;
//! assert_eq!(results.robots.len(), search.strategy().budget());
//! for finalist in search.finalists(&results, &options)? {
//!     println!("{}", finalist.card());
//! }
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! # The file
//!
//! ```
//! use realgap_core::file::Source;
//! use realgap_lab::search::{Overrides, Search};
//!
//! let text = r#"Search(
//!     strategy: Evolution(population: 10, generations: 10),
//!     duration_s: 20.0,
//!     objective: (measure: Displacement, aggregate: LowerQuantile(0.2)),
//!     parameters: [(name: "floor.friction", low: 0.3, high: 0.5)],
//! )"#;
//! let search = Search::parse(&Source::new("best.ron", text), &Overrides::default())?;
//! assert_eq!((search.strategy().name(), search.strategy().budget(), search.repeats()), ("evolution", 82, 8));
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! | field | meaning | default |
//! |---|---|---|
//! | `strategy` | `Evolution(population, generations, elites, selection, variation)`, `MapElites(axes, initial, batch, evaluations, variation)`, `Grid(genes)` or `CmaEs(evaluations, genes)` | |
//! | `start` | for `Grid` and `CmaEs`: `Genome("file.ron")`, or `Morphology("file.ron")` for its gait alone | |
//! | `duration_s` | length of each run | |
//! | `development` | settings of [`Development`](realgap_robot::genome::Development); a genome file has its own | |
//! | `set` | fixed parameters, `{"floor.friction": 0.4}` | |
//! | `parameters` | parameters of which only a range is known, `[(name, low, high)]`: every repeat draws values | |
//! | `indistinguishable` | a folder of `sweep` or `tune`: every repeat gets one of the points of its confidence set | |
//! | `noise` | as in a study | an estimate |
//! | `objective` | `(measure: Displacement, Straightness, Speed or SpeedPerEnergy; aggregate: Mean, LowerQuantile(level) or MeanMinusSd(k); from_s: the time before it does not count; last_quarters: a run counts for at most so many times its last quarter)` | displacement, 20 % quantile |
//! | `repeats` | runs of every robot; all robots get the same draws | 8 |
//! | `failures` | [`FailureRules`] | |
//! | `settings` | `One`, or `EquallyValid`: every repeat has its own engine and steps | `One` |
//! | `gait` | [`GaitTuning`]: every body's gait is tuned by short runs before the body is judged | bodies have the gait of their genome |
//! | `finalists` | [`FinalsSettings`] | |
//! | `seed` | of everything random | 1 |
//!
//! # Strategies alone
//!
//! [`OPERATORS`] vary genomes, [`SELECTIONS`] pick their parents, and a [`Strategy`] proposes what to try next. None of these
//! knows a simulator: the caller evaluates the proposals and passes the history back.
//!
//! ```
//! use realgap_robot::genome::Genome;
//! use realgap_lab::search::{Evaluated, Evolution, Strategy, generator};
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
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod baseline;
mod body;
mod builder;
mod descriptor;
mod evaluate;
mod failure;
mod finals;
mod finals_settings;
mod gait;
mod known_parameter;
mod objective;
mod problem;
mod robot;
mod run;
mod search_file;
mod setting;
mod strategy;

pub use crate::prediction::{UncertainParameters, UncertainRange, read_posterior};
pub use baseline::Baseline;
pub use body::Body;
pub use builder::SearchBuilder;
pub use descriptor::{Behaviour, DESCRIPTORS, Descriptor, descriptor_named};
pub use failure::{Failure, FailureRules, Reason};
pub use finals::{Finalist, rank};
pub use finals_settings::FinalsSettings;
pub use gait::GaitTuning;
pub use known_parameter::{KnownParameter, ParameterShare};
pub use objective::{Aggregate, Measure, Objective, Travel};
pub use problem::Search;
pub use realgap_store::Mode;
pub use robot::{EvaluatedRobot, Outcome, Performance};
pub use run::SearchResults;
pub use search_file::Overrides;
#[cfg(feature = "schema")]
pub use search_file::SearchFile;
pub use setting::SettingsChoice;
pub use strategy::{
    Archive, Axis, CmaEs, CmaEsSettings, Evaluated, Evolution, GeneValues, Grid, GridSettings,
    MapElites, OPERATORS, Operator, SELECTIONS, STRATEGIES, Selection, Space, Strategy,
    StrategySettings, Variation, VariationParams, generator, operator_named, selection_named,
};
