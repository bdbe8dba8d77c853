//! A study: recordings + experiment + parameters + metric, and what answers it.
//!
//! [`Study::read`] reads one from a file, [`Study::builder`] makes one in Rust. [`Study::sweep`] tries every point of its grid,
//! [`Study::tune`] lets an optimizer choose; both give an [`Answer`]: the best point, everything that cannot be told from it, an
//! interval and a [`Verdict`] a parameter. [`Study::evaluate`] checks given values, [`Study::sensitivity`] says which parameters
//! matter.
//!
//! ```
//! use realgap_optimization::RunOptions;
//! use realgap_lab::calibration::{Overrides, Study, TuneOptions};
//! use realgap_optimization::optimizer_by_name;
//!
//! let overrides = Overrides {
//!     metric: Some(realgap_path::comparison::by_name("rms")?),
//!     limit_recordings: Some(2),
//!     ..Overrides::default()
//! };
//! let study = Study::read("../../sweeps/tripod_self.ron", &overrides)?;
//! let options = TuneOptions { optimizer: optimizer_by_name("random")?, budget: 4, patience: None };
//! let answer = study.tune(&options, &RunOptions::default())?;
//! assert_eq!(answer.report.points, 4);
//! assert_eq!(answer.report.verdicts[0].parameter, "floor.friction");
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod answer;
mod audit;
mod basis;
mod builder;
mod case;
mod command_file;
mod definition;
mod doubt;
mod engines;
mod estimate;
mod evaluation;
mod fingerprint;
mod fit;
mod fitted;
mod fleet;
mod horizon;
mod inference;
mod joint_evaluation;
mod joints;
mod keeping;
mod likeness;
mod matching;
mod method;
mod misfit;
mod motion;
mod nearness;
mod noise;
mod overrides;
mod posterior;
mod profile;
mod recording;
mod repeat;
mod report;
mod reproduction;
mod rest;
mod robot_file;
mod scene_file;
mod score;
mod sensitivity;
mod setting;
mod sieve;
mod split;
mod stand_in;
mod steering;
mod study;
mod study_file;
mod sweep;
mod transfer;
mod tune;
mod uncertainty;
mod validation;
mod values;
mod verdict;
mod wave;
#[cfg(test)]
mod world;

pub use answer::Answer;
pub use audit::{Audit, AuditRow};
pub use basis::BasisRule;
pub use builder::StudyBuilder;
pub use case::{Case, Target};
pub use command_file::{BetweenCommands, CommandColumn, Commands, Off};
pub use definition::{Definition, ScoreRule, StartRule, StartUsed};
pub use engines::EngineWish;
pub use evaluation::{Average, Evaluation, RecordingErrors};
pub use fit::Fit;
pub use fitted::recording_id;
pub use fleet::Member;
pub use horizon::Horizon;
pub use inference::LEVEL;
pub use joint_evaluation::{JointErrors, JointEvaluation};
pub use joints::Unmatched;
pub use method::{Estimated, Method, Termination, Tuned};
pub use misfit::{Change, Misfit};
pub use motion::InformationGain;
pub use noise::read_noise;
pub use overrides::{Overrides, Part};
pub use posterior::{BestDraws, INTERVAL_LEVEL};
pub use profile::Profile;
pub use realgap_store::Mode;
pub use recording::{few_recordings, recording_paths, recording_warnings};
pub use repeat::{RepeatCase, Repeatable};
pub use report::{Best, BestPointUncertainty, Correlation, PoseErrors, Report};
pub use reproduction::{Likeness, MetricFloors, Reproduction, RobotReproduction};
pub use rest::{FaceOdds, RestingOdds};
pub use score::{PointScore, Scores};
pub use sensitivity::{Effect, Sensitivity};
pub use split::Split;
pub use stand_in::{NoiseReport, RecordReport, StandIn};
pub use steering::Steering;
pub use study::Study;
#[cfg(feature = "schema")]
pub use study_file::StudyFile;
pub use transfer::{OwnParameters, RobotMisfit, Transfer};
pub use tune::TuneOptions;
pub use uncertainty::{Uncertainty, UncertaintySource, Unvisited};
pub use validation::{Fold, Validation};
pub(crate) use values::by_name;
pub use values::{BestFile, Fitted, read_best, read_parameters, study_of};
pub use verdict::{Tables, Verdict};
