//! The minimum of a quadratic function within the unit cube.

use nalgebra::{DMatrix, DVector};

use super::super::UnitPoint;

/// Where a quadratic function with this curvature, and this slope at `from`, is lowest within the range. `held` are the coordinates that
/// are not moved. One that would go beyond an end of the range is moved to that end, and the others are computed again. Where the
/// curvature is not positive definite, the others stay where they are.
pub fn minimum_within(
    curvature: &DMatrix<f64>,
    slope: &DVector<f64>,
    from: &[f64],
    mut held: Vec<bool>,
) -> UnitPoint {
    let mut to = from.to_vec();
    // Each round fixes at least one more coordinate at an end.
    for _ in 0..=from.len() {
        let free: Vec<usize> = (0..from.len()).filter(|axis| !held[*axis]).collect();
        let matrix = curvature.select_rows(&free).select_columns(&free);
        let right = DVector::from_fn(free.len(), |row, _| {
            let moved: f64 = (0..from.len())
                .filter(|axis| held[*axis])
                .map(|axis| curvature[(free[row], axis)] * (to[axis] - from[axis]))
                .sum();
            -slope[free[row]] - moved
        });
        let steps = match matrix.cholesky() {
            Some(cholesky) => cholesky.solve(&right),
            None => DVector::zeros(free.len()),
        };
        let mut is_within = true;
        for (axis, step) in free.iter().zip(steps.iter()) {
            let target = from[*axis] + step;
            to[*axis] = target.clamp(0.0, 1.0);
            if to[*axis] != target {
                (held[*axis], is_within) = (true, false);
            }
        }
        if is_within {
            break;
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_an_end_of_the_range_the_other_coordinate_is_the_lowest_there() {
        // (x − 2)² + (x − 2)(y − 0.5) + (y − 0.5)² is lowest at (2, 0.5), and for x = 1 at y = 1.
        let curvature = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let from = [0.5, 0.5];
        let slope = &curvature * DVector::from_vec(vec![from[0] - 2.0, from[1] - 0.5]);
        let to = minimum_within(&curvature, &slope, &from, vec![false; 2]);
        assert!(
            (to[0] - 1.0).abs() < 1e-12 && (to[1] - 1.0).abs() < 1e-12,
            "{to:?}"
        );
        let to = minimum_within(&curvature, &slope, &from, vec![true, false]);
        assert_eq!(to[0], 0.5);
    }
}
