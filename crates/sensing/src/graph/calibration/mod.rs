//! From a log of scans to a sensorgraph: walks that log, the fit, its evaluation on a log that it has not seen, and its export as code.

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
