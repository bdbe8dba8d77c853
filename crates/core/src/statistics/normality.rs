//! A test of normality: does a sample come from a normal distribution?

use crate::error::Result;
use crate::statistics::rank::check_sample;
use crate::statistics::significance::SampleTest;
use crate::statistics::{mean, standard_deviation};

/// The smallest number of values that [`anderson_darling`] accepts.
pub const LEAST_FOR_NORMALITY: usize = 8;

/// Anderson–Darling test of normality with mean and variance estimated: A²* = A² (1 + 0.75/n + 2.25/n²) and its p value by
/// D'Agostino & Stephens (1986, table 4.9), as in `statsmodels.stats.diagnostic.normal_ad`.
///
/// Rounded readings are not normal: large samples of a sensor with a coarse resolution are rejected because of the steps alone.
///
/// # Errors
/// Fewer than 8 values, values that are not finite. A sample of equal values is not normal: p = 0.
pub fn anderson_darling(values: &[f64]) -> Result<SampleTest> {
    check_sample("values", values, LEAST_FOR_NORMALITY)?;
    let (centre, sd) = (mean(values), standard_deviation(values));
    if sd == 0.0 {
        return Ok(SampleTest::asymptotic(f64::MAX, 0.0));
    }
    let mut z: Vec<f64> = values.iter().map(|v| (v - centre) / sd).collect();
    z.sort_by(f64::total_cmp);
    let n = z.len() as f64;
    let log_below = |z: f64| {
        libm::log((0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)).max(f64::MIN_POSITIVE))
    };
    let sum: f64 = z
        .iter()
        .zip(z.iter().rev())
        .enumerate()
        .map(|(i, (low, high))| (2.0 * i as f64 + 1.0) * (log_below(*low) + log_below(-high)))
        .sum();
    let statistic = -n - sum / n;
    let a = statistic * (1.0 + 0.75 / n + 2.25 / (n * n));
    let p_value = if a < 0.2 {
        1.0 - libm::exp(-13.436 + 101.14 * a - 223.73 * a * a)
    } else if a < 0.34 {
        1.0 - libm::exp(-8.318 + 42.796 * a - 59.938 * a * a)
    } else if a < 0.6 {
        libm::exp(0.9177 - 4.279 * a - 1.38 * a * a)
    } else if a < 13.0 {
        libm::exp(1.2937 - 5.709 * a + 0.0186 * a * a)
    } else {
        0.0
    };
    Ok(SampleTest::asymptotic(statistic, p_value))
}
