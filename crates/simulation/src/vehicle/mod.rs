//! A two-wheel robot that moves by dead reckoning and avoids what its range sensor sees (paper 000).
//!
//! It stands where a modular robot stands elsewhere: an [`Experiment`](super::Experiment) with a [`Vehicle`] is run by its own epochs
//! instead of by the engine, and everything after it (noise, camera, ensembles, gaps, sweeps) is the same. [`Drive`] holds the numbers
//! that may be set and fitted.

mod drive;
mod file;
mod motion;
mod robot;
mod sense;

use std::sync::Arc;

use realgap_sensing::arena::Arena;
use realgap_sensing::range::RangeModel;

pub use drive::Drive;
#[cfg(feature = "schema")]
pub use file::VehicleFile;
pub(super) use motion::run;

/// A two-wheel robot in its arena.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// Its name.
    pub name: String,
    /// Radius of the circle that it is, metres.
    pub radius_m: f64,
    /// Where it drives.
    pub arena: Arc<Arena>,
    /// Where other robots of its kind begin to drive, x and y in metres and heading in radians: they see and avoid one another.
    pub others: Vec<[f64; 3]>,
    /// What it sees with.
    pub sensor: Arc<RangeModel>,
    /// Its numbers where a study sets nothing else.
    pub drive: Drive,
    /// The files' texts, for hashes.
    pub text: String,
}
