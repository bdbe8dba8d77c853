//! Splits the residuals of a fit into shadowing, which is common to all readings at one spot, and fading, which differs between
//! readings.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::covariance::{SPOT_M, Spread, covariance};
use super::log::RadioLog;

/// Pairs of spots with larger distances than this are not used to estimate the correlation, metres.
const FAR_M: f64 = 4.0;
/// Largest number of spots of one anchor that are compared with each other.
const MOST_SPOTS: usize = 2000;

/// Number of corrections of the covariances for the part of shadowing that the fit has absorbed.
const CORRECTIONS: usize = 4;

/// Splits the variance of residuals (in the log's order) into shadowing, which is common to a spot, and fading. The covariance
/// s² exp(−h/L) of shadowing is fitted to products of the means of spots at distance h (Gudmundson 1991). The fit has absorbed a part
/// of shadowing; this part, computed from the rows and the covariance of the parameters, is added back. The sum of both variances is at
/// least the variance of the residuals.
pub(super) fn estimate(log: &RadioLog, residuals_db: &[f64], rows: &[Vec<f64>]) -> Spread {
    let mut spread = split(log, residuals_db, rows, None);
    for _ in 0..CORRECTIONS {
        let covariance = covariance(log, rows, &spread);
        spread = split(log, residuals_db, rows, covariance.as_ref());
    }
    // If no spot has several readings and few spots are near each other, the split underestimates the variance; the rest is added to
    // fading.
    let parameters = rows.first().map_or(0, Vec::len);
    let squares: f64 = residuals_db.iter().map(|r| r * r).sum();
    let all = squares / residuals_db.len().saturating_sub(parameters).max(1) as f64;
    let found = spread.shadowing_sd_db.powi(2) + spread.fading_sd_db.powi(2);
    spread.fading_sd_db = spread.fading_sd_db.hypot((all - found).max(0.0).sqrt());
    spread
}

fn split(
    log: &RadioLog,
    residuals_db: &[f64],
    rows: &[Vec<f64>],
    covariance: Option<&DMatrix<f64>>,
) -> Spread {
    let bins = (FAR_M / SPOT_M) as usize;
    let (mut sums, mut counts) = (vec![0.0; bins], vec![0.0; bins]);
    let (mut within, mut degrees) = (0.0, 0.0);
    for anchor in 0..log.anchors.len() {
        let spots = spots(log, residuals_db, rows, anchor);
        for spot in &spots {
            within += spot.squares - spot.count * spot.mean * spot.mean;
            degrees += spot.count - 1.0;
        }
        let step = spots.len().div_ceil(MOST_SPOTS).max(1);
        let few: Vec<&Spot> = spots.iter().step_by(step).collect();
        for (index, a) in few.iter().enumerate() {
            let absorbed = covariance.map(|c| c * &a.row);
            for b in &few[index + 1..] {
                let distance_m = (a.at_m[0] - b.at_m[0]).hypot(a.at_m[1] - b.at_m[1]);
                let bin = (distance_m / SPOT_M) as usize;
                if bin < bins {
                    let absorbed = absorbed.as_ref().map_or(0.0, |part| part.dot(&b.row));
                    sums[bin] += a.mean * b.mean + absorbed;
                    counts[bin] += 1.0;
                }
            }
        }
    }
    let fading2 = if degrees > 0.0 {
        (within / degrees).max(0.0)
    } else {
        0.0
    };
    // For every L, the best s² is the solution of a linear problem.
    let best = (1..=100)
        .map(|step| {
            let distance_m = 0.1 * f64::from(step);
            let (mut num, mut den, mut own) = (0.0, 0.0, 0.0);
            for bin in 0..bins {
                if counts[bin] > 0.0 {
                    let shape = libm::exp(-(bin as f64 + 0.5) * SPOT_M / distance_m);
                    let covariance = sums[bin] / counts[bin];
                    num += counts[bin] * shape * covariance;
                    den += counts[bin] * shape * shape;
                    own += counts[bin] * covariance * covariance;
                }
            }
            let variance = if den > 0.0 { (num / den).max(0.0) } else { 0.0 };
            let miss = own - 2.0 * variance * num + variance * variance * den;
            (miss, variance, distance_m)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, variance, distance_m) = best.unwrap_or((0.0, 0.0, 1.0));
    Spread {
        shadowing_sd_db: variance.sqrt(),
        shadowing_distance_m: distance_m,
        fading_sd_db: fading2.sqrt(),
    }
}

/// The residuals at one spot (a square of a quarter of a metre).
struct Spot {
    at_m: [f64; 2],
    count: f64,
    mean: f64,
    squares: f64,
    /// Mean of the rows of its readings.
    row: DVector<f64>,
}

/// The residuals of one anchor, grouped by spot.
fn spots(log: &RadioLog, residuals_db: &[f64], rows: &[Vec<f64>], anchor: usize) -> Vec<Spot> {
    let mut cells: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (index, reading) in log.readings.iter().enumerate() {
        if reading.anchor == anchor {
            let cell = reading.position_m.map(|v| (v / SPOT_M).floor() as i64);
            cells.entry(cell).or_default().push(index);
        }
    }
    let of = |(cell, own): ([i64; 2], Vec<usize>)| {
        let count = own.len() as f64;
        let mut row = DVector::zeros(rows[own[0]].len());
        for index in &own {
            row += DVector::from_column_slice(&rows[*index]) / count;
        }
        Spot {
            at_m: cell.map(|k| (k as f64 + 0.5) * SPOT_M),
            count,
            mean: own.iter().map(|i| residuals_db[*i]).sum::<f64>() / count,
            squares: own.iter().map(|i| residuals_db[*i].powi(2)).sum(),
            row,
        }
    };
    cells.into_iter().map(of).collect()
}
