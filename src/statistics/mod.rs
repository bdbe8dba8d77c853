//! Numbers about samples: what a spread is, how sure a share is, and resampling.
//!
//! Checked against scipy and statsmodels where they have the same quantity (tests/statistic.rs).

mod bootstrap;
mod describe;
mod matern;
mod proportion;
mod rank;
mod significance;

pub use bootstrap::{Resample, percentile_interval, resamples, smaller_resamples};
pub use describe::{mean, median, quantile, standard_deviation};
pub use matern::matern_5_2;
pub use proportion::{Proportion, normal_quantile};
pub use significance::{PValueMethod, SampleTest, kolmogorov_smirnov, mann_whitney, spearman};
