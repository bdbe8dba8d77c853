//! Root mean square and mean square distances of paths, point by point.

use super::prepare::Prepared;

/// Root mean square distance of corresponding points of two prepared paths in the plane, metres: the metric `rms`.
pub fn rms_m(a: &Prepared, b: &Prepared) -> f64 {
    mean_square_m2(a.xy_m(), b.xy_m()).sqrt()
}

/// Mean square distance of corresponding points of two paths, m².
pub fn mean_square_m2(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let sum: f64 = a
        .iter()
        .zip(b)
        .map(|(p, q)| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2))
        .sum();
    sum / a.len() as f64
}
