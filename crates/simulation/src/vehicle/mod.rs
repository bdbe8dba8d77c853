//! Kinematic model of a two-wheel robot that moves by dead reckoning and avoids obstacles with its range sensor (paper 000).
//!
//! It takes the place of a modular robot: an [`Experiment`](super::Experiment) with a [`Vehicle`] is simulated in epochs by the
//! equations of this module instead of by an engine, and all later processing (noise, camera, ensembles, gaps, sweeps) is the
//! same. [`Drive`] contains the parameters that can be set and fitted.

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
    /// Radius of its circular body, metres.
    pub radius_m: f64,
    /// The arena in which it drives.
    pub arena: Arc<Arena>,
    /// Starts of other robots of the same kind, x and y in metres and heading in radians; the robots detect and avoid each other.
    pub others: Vec<[f64; 3]>,
    /// Model of its range sensor.
    pub sensor: Arc<RangeModel>,
    /// Its parameters, unless a study sets others.
    pub drive: Drive,
    /// Texts of all its files, for hashes.
    pub text: String,
}
