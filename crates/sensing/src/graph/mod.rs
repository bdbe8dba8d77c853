//! Sensorgraphs: models that predict the ranges of a scanner at a position by polynomials (paper 001).
//!
//! A [`ScanLog`] of poses and scans is reduced to medians of segments. For each heading and segment, or for each direction of the
//! world, [`fit`](fit()) finds a polynomial in (x, y) whose terms are chosen by forward regression ([`regression`]). An
//! [`Evaluation`] tests the model on a log that was not used for the fit, and compares its errors with those of baselines.

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
