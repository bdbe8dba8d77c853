//! Noise that a series shows by itself: what is left of it in differences of high order.

use realgap_core::statistics::median;

/// Orders of the differences that show noise.
const LOWEST_ORDER: usize = 2;
const HIGHEST_ORDER: usize = 6;
/// Median of the absolute value of a normal number of standard deviation 1.
const MEDIAN: f64 = 0.674_49;

/// Standard deviation of the noise of values that change smoothly; infinite for too few values.
///
/// Differences of order k are taken, whose coefficients have squares that sum up to (2k)!/(k!)². A smooth signal contributes less the
/// higher the order, and noise contributes the same, so the smallest estimate of several orders is taken (Gasser, Sroka &
/// Jennen-Steinmetz 1986 take the second order).
pub fn rough_noise(values: &[f64]) -> f64 {
    let (mut differences, mut squares) = (values.to_vec(), 1.0);
    let mut rough = f64::INFINITY;
    for order in 1..=HIGHEST_ORDER {
        differences = differences.windows(2).map(|v| v[1] - v[0]).collect();
        squares *= (4.0 * order as f64 - 2.0) / order as f64;
        if order >= LOWEST_ORDER && !differences.is_empty() {
            let sizes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
            rough = rough.min(median(&sizes) / MEDIAN / squares.sqrt());
        }
    }
    rough
}
