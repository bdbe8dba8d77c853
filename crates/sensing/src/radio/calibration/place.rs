//! Groups readings into places (squares of one metre), and solves least squares with whole places left out.
//!
//! Readings less than a metre from each other have correlated errors, so cross-validation and resampling do not split a place.

use nalgebra::{DMatrix, DVector};

use super::log::RadioLog;

/// Side of the square that is one place, metres.
pub(super) const PLACE_M: f64 = 1.0;

/// The place of each reading, numbered in the order of the log, and the number of places.
pub(super) fn places(log: &RadioLog) -> (Vec<usize>, usize) {
    let mut known: Vec<[i64; 2]> = Vec::new();
    let of = log
        .readings
        .iter()
        .map(|reading| {
            let cell = reading.position_m.map(|v| (v / PLACE_M).floor() as i64);
            known
                .iter()
                .position(|other| *other == cell)
                .unwrap_or_else(|| {
                    known.push(cell);
                    known.len() - 1
                })
        })
        .collect();
    (of, known.len())
}

/// The normal equations of least squares, separately for each place.
pub(super) struct ByPlace {
    matrices: Vec<DMatrix<f64>>,
    rights: Vec<DVector<f64>>,
}

impl ByPlace {
    /// The normal equations of these rows and targets.
    pub(super) fn new(rows: &[Vec<f64>], targets: &[f64], place: &[usize], places: usize) -> Self {
        let columns = rows.first().map_or(0, Vec::len);
        let mut matrices = vec![DMatrix::zeros(columns, columns); places];
        let mut rights = vec![DVector::zeros(columns); places];
        for ((row, target), place) in rows.iter().zip(targets).zip(place) {
            let row = DVector::from_column_slice(row);
            matrices[*place].ger(1.0, &row, &row, 1.0);
            rights[*place].axpy(*target, &row, 1.0);
        }
        Self { matrices, rights }
    }

    /// The solution with a weight for each place; `None` if the readings do not determine it.
    pub(super) fn solve(&self, weight: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let columns = self.matrices.first()?.ncols();
        let mut matrix = DMatrix::zeros(columns, columns);
        let mut right = DVector::zeros(columns);
        for (place, (own, own_right)) in self.matrices.iter().zip(&self.rights).enumerate() {
            let weight = weight(place);
            if weight != 0.0 {
                matrix += weight * own;
                right.axpy(weight, own_right, 1.0);
            }
        }
        // The parameter of a column that is nearly a linear combination of others is not determined.
        let scale: Vec<f64> = (0..columns).map(|k| matrix[(k, k)].sqrt()).collect();
        if scale.iter().any(|s| *s <= 0.0 || !s.is_finite()) {
            return None;
        }
        let scaled = DMatrix::from_fn(columns, columns, |i, j| {
            matrix[(i, j)] / (scale[i] * scale[j])
        });
        let factor = scaled.cholesky()?;
        if factor.l_dirty().diagonal().iter().any(|d| *d < 1e-6) {
            return None;
        }
        let solved = factor.solve(&DVector::from_fn(columns, |k, _| right[k] / scale[k]));
        let values: Vec<f64> = (0..columns).map(|k| solved[k] / scale[k]).collect();
        values.iter().all(|v| v.is_finite()).then_some(values)
    }
}
