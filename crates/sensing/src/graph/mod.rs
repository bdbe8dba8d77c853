//! Sensorgraphs: models that predict the ranges of a scanner at a position by polynomials (paper 001).
//!
//! A [`Sensorgraph`] predicts the ranges of a scanner at any pose. With the feature `papers`, it can also be fitted to a log and
//! evaluated: a [`ScanLog`] of poses and scans is reduced to medians of segments. For each heading and segment, or for each direction
//! of the world, [`fit`](fit()) finds a polynomial in (x, y) whose terms are chosen by forward regression ([`regression`]). An
//! [`Evaluation`] tests the model on a log that was not used for the fit, and compares its errors with those of baselines.

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
