//! Statistics of samples: descriptive numbers, intervals, tests and resampling.
//!
//! They are checked against scipy and statsmodels where these libraries have the same quantity (tests/statistic.rs).

mod autocorrelation;
mod bootstrap;
mod describe;
mod energy;
mod forecast;
mod jackknife;
mod normality;
mod paired;
mod proportion;
mod rank;
mod significance;
mod survival;
mod truncated_normal;

pub use autocorrelation::{autocorrelation_time, independent_pairs};
pub use bootstrap::{Resample, percentile_interval, resamples, smaller_resamples};
pub use describe::{
    ends_of, least_by, mean, mean_of, mean_of_any, median, quantile, standard_deviation,
};
pub use energy::{EnergyTest, PERMUTATIONS, energy_test};
pub use forecast::{ReliabilityBin, brier, reliability};
pub use jackknife::jackknife_variance;
pub use jackknife::{
    Degree, chi_squared_quantile, fisher_tail, jackknife_interval, student_quantile,
};
pub use normality::{LEAST_FOR_NORMALITY, anderson_darling};
pub use paired::{PairedTest, wilcoxon_signed_rank};
pub use proportion::{Proportion, normal_quantile};
pub use significance::{
    PValueMethod, SampleTest, kolmogorov_smirnov, mann_whitney, spearman, spearman_effective,
};
pub use survival::{Duration, KaplanMeier, log_rank};
pub use truncated_normal::truncated_normal_quantile;
