//! Optimization: grids, optimizers that are pure functions of the history, and the parallel driver.
//!
//! What is evaluated comes in as a closure: this room knows neither simulator nor metric.

mod driver;
pub mod gaussian_process;
mod grid;
mod minimise;
mod optimizer;
mod options;

pub use driver::{Batch, Ending, drive};
pub use grid::{Grid, MAX_POINTS, Range};
pub use minimise::minimise;
pub use optimizer::{
    EvaluatedPoint, History, OPTIMIZERS, OptimizationProblem, Optimizer, Proposal, Quadratic,
    UnitPoint, default_optimizer, optimizer_by_name, slopes, space_filling, thin,
};
pub use options::{Progress, RunOptions, pool};
