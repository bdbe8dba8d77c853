//! From a log of strengths at known places to a radio model, and its evaluation on a log that it has not seen.

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
