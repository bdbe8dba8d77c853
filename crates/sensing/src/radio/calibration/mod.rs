//! Calibration of a radio model: fits it to a log of strengths at known positions, and evaluates it on a log that was not used for
//! the fit.

mod check;
mod covariance;
mod evaluation;
mod fingerprint;
mod fit;
mod fitted;
mod interval;
mod log;
mod option;
mod place;
mod shadowing;

pub use evaluation::{AnchorReport, CELL_M, Evaluation, RadioBaseline};
pub use fingerprint::Fingerprints;
pub use fit::fit;
pub use fitted::{Candidate, FittedParameter, FittedRadio};
pub use log::{PlaceReading, RadioLog, RadioLogOptions, read_anchors};
pub use option::RadioOptions;
