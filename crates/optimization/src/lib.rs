//! Optimization: grids, optimizers that are pure functions of the history, and the parallel driver.
//!
//! The caller passes the function to be evaluated as a closure; this crate depends on neither a simulator nor a metric.

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
    ErrorBlock, EvaluatedPoint, History, Linearisation, OPTIMIZERS, OptimizationProblem, Optimizer,
    Proposal, UnitPoint, blocks_of, default_optimizer, error_scales, minimum_within,
    optimizer_by_name, robust_loss, robust_slope, slopes, space_filling, thin,
};
pub use options::{Progress, RunOptions, Step, pool};
