//! Compares real and simulated task times, including those of trials that were given up (paper 002, section V).
//!
//! A [`TaskLog`] has one row for each trial: a duration, whether the task was finished, and further columns that state the conditions.
//! A [`TaskComparison`] compares the real and the simulated trials of each condition, and tests whether the order of the conditions
//! is the same in both.
//!
//! ```
//! use realgap_sensing::task::{TaskComparison, TaskLog};
//!
//! let real = TaskLog::parse("real.csv", "robot,duration_s\na,10\na,12\na,11\nb,30\nb,28\nb,33\n")?;
//! let simulated = TaskLog::parse("sim.csv", "robot,duration_s\na,11\na,9\na,12\nb,25\nb,35\nb,30\n")?;
//! let found = TaskComparison::new(&real, &simulated, 1)?;
//! assert_eq!(found.conditions[0].condition, "robot=a");
//! assert_eq!(found.factors[0].real, ["a", "b"]);
//! assert!(found.factors[0].same_order);
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod comparison;
mod log;
mod reach;

pub use comparison::{ConditionReport, FactorReport, SideReport, TaskComparison};
pub use log::{TaskLog, Trial};
pub use reach::{Goal, time_to_reach};
