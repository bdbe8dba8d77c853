//! The robust loss of one error: quadratic for small errors, linear for large ones (Charbonnier et al. 1997).
//!
//! Errors are in typical errors of their channel.

/// The loss.
pub fn robust_loss(error: f64) -> f64 {
    root(error) - 1.0
}

/// The derivative of the loss.
pub fn robust_slope(error: f64) -> f64 {
    error / root(error)
}

/// The weight of the error in iteratively reweighted least squares.
pub(super) fn robust_weight(error: f64) -> f64 {
    1.0 / root(error)
}

fn root(error: f64) -> f64 {
    (1.0 + error * error).sqrt()
}
