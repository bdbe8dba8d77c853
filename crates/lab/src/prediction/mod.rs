//! What the simulation says about reality, and how far it can be trusted.
//!
//! [`ensemble`] repeats one robot under noise; a [`Card`] says what the repeats mean for somebody who wants to build the
//! robot; an [`EnsembleReport`] holds the repeats of a study against its recordings, and [`gap`] says how many of reality's own
//! noise floors lie between the two.
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
mod uncertain;

pub use card::{Card, Finals, Rerun, Success, SuccessRule};
pub use cost_of_transport::CostOfTransport;
pub use divergence_rate::DivergenceRate;
pub use model::{LEVEL, Model, ModelError, Range, Source, SuccessRange};
pub use odds::{EndCoverage, Odds, OddsOptions, RecordingOdds, RunErrors, Scored};
pub use other_engine::{Judged, OtherEngine, OwnEngines};
pub use report::{EnsembleCase, EnsembleOptions, EnsembleReport};
pub use uncertain::{UncertainParameters, UncertainRange, read_posterior};
