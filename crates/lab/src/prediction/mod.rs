//! Predictions about reality, and how far they can be trusted.
//!
//! [`ensemble`] repeats one robot under noise; a [`Card`] summarises the repeats for a person who wants to build the robot; an
//! [`EnsembleReport`] compares the repeats of a study with its recordings, and [`gap`] measures their distance in noise floors of
//! the recordings.
//!
//! ```
//! use realgap_optimization::RunOptions;
//! use realgap_lab::calibration::{Overrides, Repeatable};
//! use realgap_lab::prediction::{EnsembleOptions, EnsembleReport};
//!
//! let overrides = Overrides { limit_recordings: Some(2), ..Overrides::default() };
//! let study = Repeatable::read("../../sweeps/tripod_self.ron", &overrides)?;
//! let options = EnsembleOptions {
//!     noise: study.noise()?,
//!     noise_from: "the study".to_owned(),
//!     repeats: 4,
//!     seed: 1,
//!     model: None,
//! };
//! let report = EnsembleReport::new(&study, &options, &RunOptions::default())?;
//! assert_eq!(report.cases[0].forecast.repeats, 4);
//! assert!(report.to_string().contains("energy score"));
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod alternative;
mod card;
mod cost_of_transport;
mod divergence_rate;
pub mod ensemble;
pub mod gap;
mod kept;
mod model;
mod odds;
mod other_engine;
mod report;
mod third_opinion;
mod uncertain;

pub use card::{Card, Finals, Rerun, Success, SuccessRule};
pub use cost_of_transport::CostOfTransport;
pub use divergence_rate::DivergenceRate;
pub use model::{LEVEL, Model, ModelError, ModelOptions, Range, Source, SuccessRange};
pub use odds::{EndCoverage, Odds, OddsOptions, RecordingOdds, RunErrors, Scored};
pub use other_engine::{Judged, OtherEngine, OwnEngines};
pub use report::{EnsembleCase, EnsembleOptions, EnsembleReport};
pub use third_opinion::{Mujoco, OpinionSource, Teller, ThirdOpinion};
pub use uncertain::{UncertainParameters, UncertainRange, read_posterior};
