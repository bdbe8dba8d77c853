//! What the simulation says about reality, and how far it can be trusted.
//!
//! [`ensemble`] repeats one robot under noise; a [`Card`] says what the repeats mean for somebody who wants to build the
//! robot; [`gap`] holds such repeats against recordings, in units of reality's own noise floor.

mod card;
pub mod ensemble;
pub mod gap;
mod report;

pub use card::{Card, Finals, Rerun, Success, SuccessRule};
pub use report::{EnsembleCase, EnsembleOptions, EnsembleReport};
