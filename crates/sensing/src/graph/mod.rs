//! Sensorgraphs: what a scanner reads at a place, as transparent polynomials (paper 001).
//!
//! A [`ScanLog`] of poses and scans becomes medians of segments; for each heading and segment, or for each direction of the world,
//! [`fit`](fit()) finds a polynomial in (x, y) whose terms forward regression chooses ([`regression`]). An [`Evaluation`] holds the
//! model against a log that it has not seen, beside the guesses that a reader would ask for.

mod evaluation;
mod export;
mod fit;
mod logger;
mod lookup;
mod model;
mod option;
mod polynomial;
pub mod regression;
mod sample;
mod scan;

pub use evaluation::{Evaluation, SegmentReport};
pub use export::{Language, functions};
pub use fit::{FittedGraph, Lag, fit};
pub use logger::Logger;
pub use model::{Frame, LoggedPose, Polynomial, Sensorgraph, Term};
pub use option::GraphOptions;
pub use scan::{Scan, ScanLog};
