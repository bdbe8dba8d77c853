//! A study: experiment + recordings + parameters + metric, read from RON and made ready to evaluate.
//!
//! [`Study::read`] parses the file, [`Problem::new`] turns it into cases (one simulation each),
//! [`Problem::evaluate`] simulates one point, [`Scores::new`] compares all points with reality.

pub mod identification;

mod answer;
mod audit;
mod case;
mod clip;
mod evaluation;
mod file;
mod keeping;
mod noise;
mod posterior;
mod problem;
mod profile;
mod recording;
mod repeat;
mod rest;
mod score;
mod sensitivity;
mod sweep;
mod tune;
mod uncertainty;
mod validation;
mod values;

pub use crate::store::Mode;
pub use answer::{Answer, INTERVAL_LEVEL, LEVEL, Method};
pub use audit::{Audit, AuditRow};
pub use case::{Case, Target};
pub use evaluation::{Evaluation, RecordingErrors, Spread, evaluate};
pub use file::{Overrides, Part, StartRule, Study};
pub use noise::read_noise;
pub use posterior::{BestDraws, ScoredPoint};
pub use problem::Problem;
pub use profile::Profile;
pub use recording::{recording_paths, recording_warnings};
pub use repeat::RepeatCase;
pub use rest::{FaceOdds, RestingOdds, resting_odds};
pub use score::{PointScore, Scores};
pub use sensitivity::{Effect, Sensitivity, sensitivity};
pub use sweep::sweep;
pub use tune::{Termination, TuneOptions, Tuned, tune};
pub use uncertainty::{
    Uncertainty, UncertaintySource, bootstrap_indistinguishable, spread_indistinguishable,
};
pub use validation::{Fold, Split, Validation};
pub use values::{BestFile, read_parameters};
