//! Starts that are far from where a descent ended.

use super::super::UnitPoint;
use super::problem::Linearisation;

/// How far along the direction, as shares of the way to the end of the range.
const SHARES: [f64; 2] = [0.5, 1.0];

/// Points far to both sides of the end of a descent along the direction of which its errors tell least.
pub(super) fn far_along_weakest(ended: &Linearisation) -> Vec<UnitPoint> {
    let mut scaled = ended.jacobian.clone();
    for (mut row, scale) in scaled.row_iter_mut().zip(&ended.scales) {
        row /= *scale;
    }
    let eigen = scaled.tr_mul(&scaled).symmetric_eigen();
    let line = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let mut points = Vec::new();
    for side in [-1.0, 1.0] {
        let to_end = |(at, slope): (&f64, &f64)| {
            let slope = side * slope;
            let room = if slope > 0.0 { 1.0 - at } else { *at };
            match slope.abs() < 1e-12 {
                true => f64::INFINITY,
                false => room / slope.abs(),
            }
        };
        let ends = ended.at.iter().zip(line.iter()).map(to_end);
        let room = ends.fold(f64::INFINITY, f64::min).max(0.0);
        points.extend(SHARES.map(|share| {
            let moved = ended.at.iter().zip(line.iter());
            let moved = moved.map(|(at, slope)| (at + side * share * room * slope).clamp(0.0, 1.0));
            moved.collect::<UnitPoint>()
        }));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn starts_lie_where_the_errors_at_the_end_change_least_and_within_the_range() {
        // Errors depend on the sum of the coordinates, so that their difference is free.
        let ended = Linearisation {
            at: vec![0.3, 0.6],
            errors: vec![0.1; 3],
            jacobian: DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 2.0, 2.0, 0.5, 0.5]),
            scales: vec![1.0; 3],
            indices: (0, 1),
        };
        let points = far_along_weakest(&ended);
        let mut moves: Vec<f64> = points.iter().map(|point| point[0] - 0.3).collect();
        moves.sort_by(f64::total_cmp);
        for (moved, expected) in moves.iter().zip([-0.3, -0.15, 0.3, 0.6]) {
            assert!((moved - expected).abs() < 1e-9, "{points:?}");
        }
        for point in &points {
            assert!((point[0] + point[1] - 0.9).abs() < 1e-9, "{points:?}");
            assert!(point.iter().all(|c| (0.0..=1.0).contains(c)), "{points:?}");
        }
    }
}
