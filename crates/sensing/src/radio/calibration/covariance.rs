//! The covariance of parameters that are fitted to readings with spatially correlated errors.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::log::RadioLog;

/// Side of the square that is one spot, metres; readings in it count as taken at the same position.
pub(super) const SPOT_M: f64 = 0.25;

/// The model of errors of strengths: shadowing, which depends on the position, and fading, which differs between readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) shadowing_sd_db: f64,
    pub(super) shadowing_distance_m: f64,
    pub(super) fading_sd_db: f64,
}

/// Covariance of least-squares parameters, (X'X)⁻¹ X'ΣX (X'X)⁻¹, for errors with the covariance s² exp(−h/L) between positions of one
/// anchor plus an independent part of each reading. Readings of one spot (a quarter of a metre) count as taken at its middle. `None`
/// if X'X has no inverse.
pub(super) fn covariance(
    log: &RadioLog,
    rows: &[Vec<f64>],
    spread: &Spread,
) -> Option<DMatrix<f64>> {
    let columns = rows.first()?.len();
    let mut squares = DMatrix::zeros(columns, columns);
    // Sums of the rows of each spot of each anchor.
    let mut spots: Vec<BTreeMap<[i64; 2], DVector<f64>>> = vec![BTreeMap::new(); log.anchors.len()];
    for (reading, row) in log.readings.iter().zip(rows) {
        let row = DVector::from_column_slice(row);
        squares.ger(1.0, &row, &row, 1.0);
        let cell = reading.position_m.map(|v| (v / SPOT_M).floor() as i64);
        spots[reading.anchor]
            .entry(cell)
            .and_modify(|sum| *sum += &row)
            .or_insert(row);
    }
    let mut meat = spread.fading_sd_db.powi(2) * &squares;
    for own in &spots {
        let own: Vec<_> = own.iter().collect();
        for (a, sum_a) in &own {
            // The sum over all spots, weighted by their correlation with this spot.
            let mut shared = DVector::zeros(columns);
            for (b, sum_b) in &own {
                let [dx, dy] = [0, 1].map(|k| (a[k] - b[k]) as f64 * SPOT_M);
                let share = libm::exp(-dx.hypot(dy) / spread.shadowing_distance_m);
                shared.axpy(share, *sum_b, 1.0);
            }
            meat.ger(spread.shadowing_sd_db.powi(2), *sum_a, &shared, 1.0);
        }
    }
    let inverse = squares.try_inverse()?;
    Some(&inverse * meat * &inverse)
}
