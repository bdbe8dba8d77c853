//! A study: recordings, an experiment, parameters and a metric, and the methods that answer it.
//!
//! [`Study::read`] reads a study from a file, [`Study::builder`] builds one in Rust. [`Study::sweep`] simulates every point of
//! its grid, [`Study::tune`] lets an optimizer choose the points. Both give an [`Answer`]: the best point, the confidence set,
//! and an interval and a [`Verdict`] per parameter. [`Study::evaluate`] checks given values, [`Study::sensitivity`] shows which
//! parameters matter.
//!
//! The numbers come from the crate `realgap-inference`, which knows no robot; here are the studies that it is applied to:
//!
//! - `study`: the definition of a study, its file, its cases.
//! - `recording`: recordings of a study, found, read and checked.
//! - `exploration`: sweep, tuning and the waves after them.
//! - `numerics`: equally valid settings, the second engine, the numerical audit, the cost of a run.
//! - `goodness_of_fit`: whether the model explains the recordings at all.
//! - `answer`: scores, confidence set, verdicts, report, files of parameter values.
//! - `evaluation`: given values on recordings, held-out recordings, sensitivity, transfer between robots.
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
mod evaluation;
mod exploration;
mod goodness_of_fit;
mod numerics;
mod recording;
mod study;

pub use answer::Answer;
pub(crate) use answer::relation::DIFFERENCE_LEVEL;
pub use answer::relation::{Correlation, Difference};
pub use answer::report::{Best, BestPointUncertainty, PoseErrors, Report};
pub use answer::score::{PointScore, Scores};
pub use answer::uncertainty::{Uncertainty, UncertaintySource};
pub(crate) use answer::values::by_name;
pub use answer::values::{BestFile, Fitted, read_best, read_parameters, study_of};
pub use answer::verdict::{Tables, Verdict};
pub use evaluation::band::{Bands, ChannelBand};
pub use evaluation::channels::ChannelSummary;
pub use evaluation::determination::{Determination, Determined, FurtherMotion, Trade};
pub use evaluation::horizon_error::HorizonError;
pub use evaluation::joints::{JointErrors, JointEvaluation};
pub use evaluation::prior_run::{PriorPoint, PriorRun, PriorRuns};
pub use evaluation::reproduction::{Likeness, MetricFloors, Reproduction, RobotReproduction};
pub use evaluation::resting::{FaceOdds, RestingOdds};
pub use evaluation::sensitivity::Sensitivity;
pub use evaluation::transfer::{OwnParameters, RobotMisfit, Transfer};
pub use evaluation::validation::{Fold, Validation};
pub use evaluation::{Average, Evaluation, RecordingErrors};
pub use exploration::information_gain::InformationGain;
pub use exploration::method::{Method, Termination, Tuned};
pub use exploration::tune::TuneOptions;
pub use goodness_of_fit::Fit;
pub use goodness_of_fit::misfit::{Change, Misfit};
pub use goodness_of_fit::pattern::Pattern;
pub use goodness_of_fit::residual::{ChannelFit, NoiseSource, ResidualFit, ResidualMisfit};
pub use numerics::audit::{Audit, AuditRow};
pub use numerics::engines::EnginePreference;
pub use realgap_inference::sensitivity::Effect;
pub use realgap_inference::{
    INTERVAL_LEVEL, LEVEL, LeastSquaresEstimate, POSSIBLE_LEVEL, PosteriorDraws, Profile, Unvisited,
};
pub use realgap_store::Mode;
pub use recording::expected_noise::{ExpectedNoise, RunStart};
pub use recording::identity::recording_id;
pub use recording::joints::Unmatched;
pub use recording::noise::read_noise;
pub use recording::recording_warnings;
pub use recording::repeat::{RepeatCase, Repeatable};
pub use recording::stand_in::{NoiseReport, RecordReport, StandIn};
pub use recording::usage::UnusedColumns;
pub(crate) use recording::{few_recordings, recording_paths};
pub use study::Study;
pub use study::basis::BasisRule;
pub use study::builder::StudyBuilder;
pub use study::case::{Case, Target};
pub use study::command_file::{
    BetweenCommands, CommandColumn, Commands, Off, RecordedCommand, commanded,
};
pub use study::definition::{BaseRule, Definition, ScoreRule, StartRule, StartUsed};
#[cfg(feature = "schema")]
pub use study::file::StudyFile;
pub use study::fleet::Member;
pub use study::horizon::Horizon;
pub use study::overrides::{Overrides, Part};
pub use study::run_parameters::Each;
pub use study::scored_columns::ScoredColumns;
pub use study::simulator_file::{CommandConsent, OwnSimulator};
pub use study::split::Split;
pub use study::steering::Steering;
pub use study::window_rule::WindowRule;
