//! The Matérn 5/2 kernel: how strongly two values of a smooth function are correlated.

/// Correlation of two values `distance` length scales apart (Rasmussen & Williams 2006, equation 4.17): 1 at distance 0.
#[inline]
pub(super) fn matern_5_2(distance: f64) -> f64 {
    let s = 5.0_f64.sqrt() * distance;
    (1.0 + s + s * s / 3.0) * libm::exp(-s)
}

/// A Matérn 5/2 kernel with one length scale per axis.
///
/// ```
/// use realgap_optimization::gaussian_process::Matern;
///
/// let kernel = Matern { lengths: vec![0.5, f64::INFINITY], variance: 2.0 };
/// assert_eq!(kernel.covariance(&[0.0, 0.0], &[0.0, 1.0]), 2.0);
/// assert!(kernel.covariance(&[0.0, 0.0], &[1.5, 0.0]) < 0.1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Matern {
    /// Length scale along each axis, in units of the coordinates; infinite where the function does not depend on the axis.
    pub lengths: Vec<f64>,
    /// Variance of the function about its mean, in squared units of the function.
    pub variance: f64,
}

impl Matern {
    /// Distance of two points in length scales.
    #[inline]
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let axes = a.iter().zip(b).zip(&self.lengths);
        axes.map(|((a, b), length)| ((a - b) / length).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// Covariance of the function's values at two points.
    #[inline]
    pub fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.variance * matern_5_2(self.distance(a, b))
    }
}
