//! Calibration of a sensorgraph: simulates a robot that logs scans, fits a model to a log, evaluates it on a log that was not used for
//! the fit, and exports it as source code.

mod evaluation;
mod export;
mod fit;
mod logger;
mod option;
mod polynomial;
pub mod regression;
mod sample;
mod scan;

pub use evaluation::{Evaluation, SegmentReport};
pub use export::{Language, functions};
pub use fit::{FittedGraph, Lag, fit};
pub use logger::Logger;
pub use option::GraphOptions;
pub use scan::{Scan, ScanLog};
