//! From a study to an answer: candidates, the parallel driver, and how sure the answer is.
//!
//! What is evaluated comes in as a closure: this room knows neither simulator nor metric.

mod driver;
mod grid;
mod optimizer;
mod posterior;
mod profile;
mod uncertainty;

pub use driver::{Ending, Evaluation, drive, pool};
pub use grid::{Grid, MAX_POINTS, Range};
pub use optimizer::{
    Brief, History, OPTIMIZERS, Optimizer, Proposal, Told, UnitPoint, optimizer_by_name,
    space_filling,
};
pub use posterior::{BestDraws, ScoredPoint};
pub use profile::Profile;
pub use uncertainty::{
    Uncertainty, UncertaintySource, bootstrap_indistinguishable, spread_indistinguishable,
};
