//! Many repeats of one experiment under noise: what will happen in reality, and with which probability.
//!
//! [`run`] simulates the repeats; [`Quantiles`], [`Envelope`] and [`behaviours`] summarise them, and [`Forecast`] holds all
//! summaries. [`Reality`] compares an ensemble with recorded paths. Paper 003 (section 4) predicted one path and saw it in 15 %
//! of the trials; this is the prediction that it asks for instead.
//!
//! ```
//! use realgap_optimization::RunOptions;
//! use realgap_lab::prediction::ensemble::{Forecast, run};
//! use realgap_robot::morphology::Morphology;
//! use realgap_simulation::{Experiment, Noise};
//!
//! let mut experiment = Experiment::new(Morphology::read("../../morphologies/tripod.ron")?.assemble());
//! experiment.duration_s = 1.0;
//! let repeats = run(&experiment, &Noise::unmeasured_robot(), 1, 6, &RunOptions::default())?;
//! let forecast = Forecast::new(&repeats)?;
//! assert!(forecast.displacement_m.is_some_and(|spread| spread.q05 <= spread.q95));
//! # Ok::<(), realgap_core::Error>(())
//! ```
//!
//! No recordings are needed. The same experiment, noise and seed give the same bits, whatever the number of threads; repeat k
//! alone is the same as repeat k of the ensemble ([`Noise::perturb`](realgap_simulation::Noise::perturb)).

mod behaviour;
mod envelope;
mod forecast;
mod forecast_text;
mod quantiles;
mod reality;
mod run;

pub use behaviour::{BEHAVIOURS, Behaviour, Behaviours, Kind, behaviours, cut_m};
pub use envelope::{Envelope, LEAST_PATHS, LEVELS, Region};
pub use forecast::Forecast;
pub use forecast_text::percent;
pub use quantiles::{QUANTILES, Quantiles};
pub use realgap_path::trajectory::rms_m;
pub(super) use reality::REPEATS_TESTED;
pub(crate) use reality::mean_distance_m;
pub use reality::{Coverage, RealRun, Reality};
pub(super) use run::must_repeat;
pub(crate) use run::no_camera;
pub use run::{Draws, Recall, run_each};
pub use run::{Ensemble, Motion, Repeat, repeat, run};
