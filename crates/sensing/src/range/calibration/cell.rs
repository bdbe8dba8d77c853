//! Groups readings of equal distance, angles and session into cells, and finds the outliers of each cell.

use super::log::ReadingLog;
use super::peak::peaks;
use crate::range::model::Outliers;
use realgap_core::statistics::{mean, median, quantile};

/// Readings at one distance and one pair of angles, in one session.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell {
    pub distance: f64,
    pub incidence_deg: f64,
    pub offset_deg: f64,
    /// Index of the session; 0 if the log names no sessions.
    pub session: usize,
    /// Readings without dropouts and outliers, in the order of the log.
    pub values: Vec<f64>,
    /// Readings that have nothing to do with the distance.
    pub outliers: Vec<f64>,
    /// Number of dropouts.
    pub dropouts: usize,
}

/// The statistics of a cell that a fit uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Summary {
    pub distance: f64,
    pub incidence_deg: f64,
    pub offset_deg: f64,
    pub session: usize,
    pub count: f64,
    pub mean: f64,
    /// Sum of squared deviations from the mean.
    pub squares: f64,
}

/// A reading is an outlier if it deviates by more than this many robust standard deviations; 6 in ten million of normal readings do.
const FAR: f64 = 5.0;
/// The limit is increased by this number divided by the number of readings, because the robust standard deviation of few readings is
/// uncertain.
const FAR_OF_FEW: f64 = 20.0;
/// Smallest number of readings of a cell in which outliers are searched for.
const LEAST: usize = 8;
/// Ratio of the standard deviation to the median absolute deviation of normally distributed readings.
const PER_MAD: f64 = 1.4826;

/// Cells of a log in order of distance and angles, and the smallest step between different readings.
pub(super) fn cells(log: &ReadingLog) -> (Vec<Cell>, f64) {
    let mut order: Vec<usize> = (0..log.readings.len()).collect();
    let key = |i: usize| {
        let r = &log.readings[i];
        [r.distance, r.incidence_deg, r.offset_deg, r.session as f64]
    };
    let compare = |a: &[f64; 4], b: &[f64; 4]| {
        let pairs = a.iter().zip(b);
        pairs
            .map(|(a, b)| a.total_cmp(b))
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    };
    order.sort_by(|&a, &b| compare(&key(a), &key(b)));
    let mut cells: Vec<Cell> = order
        .chunk_by(|&a, &b| key(a) == key(b))
        .map(|members| {
            let first = &log.readings[members[0]];
            let values: Vec<f64> = members
                .iter()
                .filter_map(|&i| log.readings[i].value)
                .collect();
            Cell {
                distance: first.distance,
                incidence_deg: first.incidence_deg,
                offset_deg: first.offset_deg,
                session: first.session,
                dropouts: members.len() - values.len(),
                values,
                outliers: Vec::new(),
            }
        })
        .collect();
    let resolution = resolution(log);
    let usual = usual_sd(&cells, resolution);
    for cell in &mut cells {
        move_outliers(cell, resolution, usual);
    }
    (cells, resolution)
}

/// Smallest difference of two different readings.
fn resolution(log: &ReadingLog) -> f64 {
    let mut values: Vec<f64> = log.readings.iter().filter_map(|r| r.value).collect();
    values.sort_by(f64::total_cmp);
    let steps = values.windows(2).map(|w| w[1] - w[0]);
    // Differences that are rounding errors of floating-point numbers are ignored.
    let size = values
        .last()
        .map_or(0.0, |v| v.abs())
        .max(values.first().map_or(0.0, |v| v.abs()));
    let least = steps
        .filter(|step| *step > 1e-9 * size)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Median and robust standard deviation of readings.
fn robust(values: &[f64]) -> (f64, f64) {
    let centre = median(values);
    let deviations: Vec<f64> = values.iter().map(|v| (v - centre).abs()).collect();
    (centre, PER_MAD * median(&deviations))
}

/// The median of the cells' robust standard deviations. It is used for a cell whose readings are nearly all rounded to the same value.
fn usual_sd(cells: &[Cell], resolution: f64) -> f64 {
    let enough = cells.iter().filter(|cell| cell.values.len() >= LEAST);
    let sds: Vec<f64> = enough.map(|cell| robust(&cell.values).1).collect();
    if sds.is_empty() {
        return resolution;
    }
    median(&sds).max(resolution)
}

/// Moves readings that are far from every peak of the cell to its outliers.
fn move_outliers(cell: &mut Cell, resolution: f64, usual: f64) {
    if cell.values.len() < LEAST {
        return;
    }
    let mut sorted = cell.values.clone();
    sorted.sort_by(f64::total_cmp);
    let reach = FAR + FAR_OF_FEW / cell.values.len() as f64;
    let intervals: Vec<(f64, f64)> = peaks(&sorted, resolution)
        .into_iter()
        .map(|peak| {
            let (centre, sd) = robust(&sorted[peak]);
            // If most readings are rounded to the same value, the robust standard deviation of the peak is too small.
            (centre, reach * if sd < resolution { usual } else { sd })
        })
        .collect();
    let is_near = |v: &f64| {
        intervals
            .iter()
            .any(|(centre, far)| (v - centre).abs() <= *far)
    };
    let (near, outliers) = cell.values.iter().copied().partition(is_near);
    cell.values = near;
    cell.outliers = outliers;
}

/// The statistics of the cells that have readings.
pub(super) fn summaries(cells: &[Cell]) -> Vec<Summary> {
    let with_values = cells.iter().filter(|cell| !cell.values.is_empty());
    with_values
        .map(|cell| {
            let centre = mean(&cell.values);
            Summary {
                distance: cell.distance,
                incidence_deg: cell.incidence_deg,
                offset_deg: cell.offset_deg,
                session: cell.session,
                count: cell.values.len() as f64,
                mean: centre,
                squares: cell.values.iter().map(|v| (v - centre).powi(2)).sum(),
            }
        })
        .collect()
}

/// The model of outliers: their share, and a uniform distribution over the interval of all readings.
pub(super) fn outlier_model(cells: &[Cell]) -> Outliers {
    let outliers: Vec<f64> = cells
        .iter()
        .flat_map(|cell| cell.outliers.iter().copied())
        .collect();
    let came: usize = cells
        .iter()
        .map(|cell| cell.values.len() + cell.outliers.len())
        .sum();
    if outliers.is_empty() {
        return Outliers::default();
    }
    let all: Vec<f64> = cells
        .iter()
        .flat_map(|cell| cell.values.iter().copied())
        .chain(outliers.iter().copied())
        .collect();
    Outliers {
        share: outliers.len() as f64 / came as f64,
        low: quantile(&all, 0.0),
        high: quantile(&all, 1.0),
    }
}
