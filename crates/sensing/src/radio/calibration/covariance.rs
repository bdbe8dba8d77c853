//! How sure parameters are when neighbouring readings share their errors.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::log::RadioLog;

/// Two readings this near to each other were taken at the same spot, metres.
pub(super) const SPOT_M: f64 = 0.25;

/// How errors of strengths lie: a part of the place and a part of the reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    pub(super) shadowing_sd_db: f64,
    pub(super) shadowing_distance_m: f64,
    pub(super) fading_sd_db: f64,
}

/// Covariance of least squares parameters whose errors have the covariance s² exp(−h/L) between places of one anchor and a part of
/// each reading: (X'X)⁻¹ X'ΣX (X'X)⁻¹. Readings of one spot (a quarter of a metre) count as taken at its middle. `None` where X'X
/// has no inverse.
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
            // Everything that shares errors with this spot.
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
