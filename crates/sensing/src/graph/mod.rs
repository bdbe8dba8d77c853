//! Sensorgraphs: models that predict the ranges of a scanner at a position by polynomials (paper 001).
//!
//! A [`Sensorgraph`] foretells the ranges of a scanner at any pose. With the feature `papers` it is calibrated, too: a [`ScanLog`] of
//! poses and scans becomes medians of segments; for each heading and segment, or for each direction of the world, [`fit`](fit())
//! finds a polynomial in (x, y) whose terms forward regression chooses ([`regression`]). An [`Evaluation`] compares the model with a
//! log that it was not fitted to, and states the errors of simple baselines beside it.

mod angle;
#[cfg(feature = "papers")]
mod calibration;
mod lookup;
mod model;
mod monomial;

#[cfg(feature = "papers")]
pub use calibration::{
    Evaluation, FittedGraph, GraphOptions, Lag, Language, Logger, Scan, ScanLog, SegmentReport,
    fit, functions, regression,
};
pub use model::{Frame, LoggedPose, Polynomial, Sensorgraph, Term};
pub use monomial::Powers;
