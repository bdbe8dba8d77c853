//! From a study to an answer: candidates, the parallel driver, and how sure the answer is.
//!
//! What is evaluated comes in as a closure: this room knows neither simulator nor metric.

mod driver;
mod grid;
mod uncertainty;

pub use driver::{Ending, Evaluation, drive};
pub use grid::{Grid, MAX_POINTS, Range};
pub use uncertainty::{
    Uncertainty, UncertaintySource, bootstrap_indistinguishable, spread_indistinguishable,
};
