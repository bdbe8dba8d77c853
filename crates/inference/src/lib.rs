//! Inference about a black box with parameters, settings and outputs: which parameter values explain some observations, and how
//! sure that is.
//!
//! The crate knows no robot, no simulator and no file. A black box is evaluated elsewhere; here are its runs: a point (coordinates from
//! 0 to 1, one a parameter), the number of a setting that is as valid as others, and a score, the discrepancy from each observation.
//!
//! - An [`Emulator`] is a Gaussian process that predicts the score of points without a run.
//! - [`HistoryMatching`] finds the points that are not implausible and gives [`PosteriorDraws`], a [`Profile`] and a [`Marginal`] per
//!   parameter; it also chooses the points of the next runs.
//! - [`LeastSquaresPosterior`] is the posterior of a fit by least squares, checked by runs at its own draws; [`LeastSquaresEstimate`] is
//!   what its draws tell about a parameter, [`added_information`] what each group of errors added to it.
//! - [`sensitivity`] has the effects of small changes, one parameter at a time.

mod candidate_sampler;
#[cfg(test)]
mod coverage;
mod emulator;
mod history_matching;
mod implausibility;
mod information;
mod kernel;
mod kernel_fit;
mod least_squares;
mod marginal;
mod noise_field;
mod posterior;
mod profile;
mod resample;
mod rough;
mod run_selection;
mod scale;
mod scored_run;
pub mod sensitivity;
mod variant_evidence;

pub use emulator::{Emulator, ScoreField};
pub use history_matching::{HistoryMatching, LEVEL, Unvisited};
pub use implausibility::{ObservationUncertainty, ScoreCovariance, implausibility};
pub use information::{AddedInformation, added_information};
pub use least_squares::{
    Agreement, Combination, Evaluate, Finer, LeastSquaresEstimate, LeastSquaresPosterior,
    RUNS_OF_NUMERICS, most_checks,
};
pub use marginal::{Determination, Marginal};
pub use posterior::{INTERVAL_LEVEL, POSSIBLE_LEVEL, PosteriorDraws};
pub use profile::{BAND, Profile};
pub use rough::rough_noise;
pub use scored_run::ScoredRun;
pub use variant_evidence::variant_probabilities;
