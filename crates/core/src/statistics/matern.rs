//! The Matérn 5/2 kernel: the correlation of two values of a smooth random function, by their distance.

/// Correlation of two values at a distance of `distance` length scales (Rasmussen & Williams 2006, equation 4.17): 1 at distance 0.
///
/// ```
/// use realgap_core::statistics::matern_5_2;
///
/// assert_eq!(matern_5_2(0.0), 1.0);
/// assert!(matern_5_2(3.0) < 0.05);
/// ```
pub fn matern_5_2(distance: f64) -> f64 {
    let s = 5.0_f64.sqrt() * distance;
    (1.0 + s + s * s / 3.0) * libm::exp(-s)
}
