//! Task times: how long people or robots take, some of them without finishing, real against simulated (paper 002, section V).
//!
//! A [`TaskLog`] has one row a trial: a duration, whether the task was finished, and any columns that say under which conditions.
//! A [`TaskComparison`] sets the real and the simulated trials of each condition beside each other, and asks whether the order of
//! the conditions is the same.
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
