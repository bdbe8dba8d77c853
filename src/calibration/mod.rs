//! A study: experiment + recordings + parameters + metric, read from RON and made ready to evaluate.
//!
//! [`Definition::read`] parses the file, [`Study::new`] turns it into cases (one simulation each),
//! [`Study::simulate`] simulates one point, [`Scores::new`] compares all points with reality.

pub mod identification;

mod answer;
mod audit;
mod builder;
mod case;
mod clip;
mod definition;
mod evaluation;
mod file;
mod fingerprint;
mod keeping;
mod method;
mod noise;
mod overrides;
mod posterior;
mod profile;
mod recording;
mod repeat;
mod report;
mod rest;
mod score;
mod sensitivity;
mod split;
mod study;
mod sweep;
mod tune;
mod uncertainty;
mod validation;
mod values;
mod verdict;

pub use crate::store::Mode;
pub use answer::{Answer, INTERVAL_LEVEL, LEVEL};
pub use audit::{Audit, AuditRow};
pub use builder::StudyBuilder;
pub use case::{Case, Target};
pub use definition::{Definition, StartRule, StartUsed};
pub use evaluation::{Average, Evaluation, RecordingErrors};
pub use method::{Method, Termination, Tuned};
pub use noise::read_noise;
pub use overrides::{Overrides, Part};
pub use posterior::{BestDraws, ScoredPoint};
pub use profile::Profile;
pub use recording::{recording_paths, recording_warnings};
pub use repeat::{RepeatCase, Repeatable};
pub use report::{Best, Correlation, HowSure, PoseErrors, Report};
pub use rest::{FaceOdds, RestingOdds};
pub use score::{PointScore, Scores};
pub use sensitivity::{Effect, Sensitivity};
pub use split::Split;
pub use study::Study;
pub use tune::TuneOptions;
pub use uncertainty::{
    Uncertainty, UncertaintySource, bootstrap_indistinguishable, spread_indistinguishable,
};
pub use validation::{Fold, Validation};
pub use values::{BestFile, read_parameters};
pub use verdict::Verdict;
