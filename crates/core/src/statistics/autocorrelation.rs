//! Autocorrelation of a series, and the number of independent values that correlated values are equivalent to.

use super::describe::mean;

/// Autocorrelations of a series at lags 1, 2, … up to the first one that is not positive; empty for fewer than four values or for equal
/// values.
///
/// Autocorrelations beyond the first that is not positive are noise (Geyer 1992 truncates in this way by pairs of lags).
fn positive_lags(values: &[f64]) -> Vec<f64> {
    let centre = mean(values);
    let deviations: Vec<f64> = values.iter().map(|v| v - centre).collect();
    let variance: f64 = deviations.iter().map(|v| v * v).sum();
    if values.len() < 4 || variance.is_nan() || variance <= 0.0 {
        return Vec::new();
    }
    (1..values.len() / 2)
        .map(|lag| {
            let pairs = deviations.iter().zip(&deviations[lag..]);
            pairs.map(|(a, b)| a * b).sum::<f64>() / variance
        })
        .take_while(|share| *share > 0.0)
        .collect()
}

/// The integrated autocorrelation time: the number of values of a series that are equivalent to one independent value, 1 + 2 Σ ρ over the
/// lags at which the autocorrelation ρ is positive.
///
/// ```
/// use realgap_core::statistics::autocorrelation_time;
///
/// let slow: Vec<f64> = (0..400).map(|k| f64::from(k / 20 % 2)).collect();
/// assert!(autocorrelation_time(&slow) > 5.0);
/// assert_eq!(autocorrelation_time(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0]), 1.0);
/// ```
pub fn autocorrelation_time(values: &[f64]) -> f64 {
    1.0 + 2.0 * positive_lags(values).iter().sum::<f64>()
}

/// The effective number of independent pairs in a correlation of two series of equal length: n / (1 + 2 Σ ρ_x ρ_y) (Bartlett 1935), at
/// most n.
pub fn independent_pairs(x: &[f64], y: &[f64]) -> f64 {
    let shared: f64 = positive_lags(x)
        .iter()
        .zip(&positive_lags(y))
        .map(|(a, b)| a * b)
        .sum();
    x.len() as f64 / (1.0 + 2.0 * shared)
}
