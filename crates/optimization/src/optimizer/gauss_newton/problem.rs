//! One linearised least-squares problem, and what is known where it ends.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::super::{OptimizationProblem, UnitPoint};
use super::log::Lean;
use super::solve;

/// The loss near a point, in coordinates from 0 to 1: what errors and prior knowledge say together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quadratic {
    /// The point with the least robust loss of all that were simulated.
    pub at: UnitPoint,
    /// The robust loss there.
    pub loss: f64,
    /// Where the best point with differences around it is in the history, and the first of the differences, one a coordinate.
    pub told: (usize, usize),
    /// Variance of an error there, as if all were independent.
    pub noise: f64,
    /// Where the loss is least by all that is known around that point.
    pub point: UnitPoint,
    /// Covariance of the point, row by row: from three logs on of what the fit would be without each of them, so wide that 1.645 of
    /// its roots hold 90 %; with fewer of the errors' noise alone, whatever else is wrong with the model.
    pub covariance: Vec<Vec<f64>>,
    /// Variance of the point by prior knowledge alone; `None` where there is none but the range.
    pub prior: Vec<Option<f64>>,
    /// How many of the errors in a row tell as much as one independent one.
    pub correlation: f64,
    /// Root of the mean square of the errors.
    pub error: f64,
}

/// Errors, and how they change with every coordinate.
#[derive(Clone)]
pub(super) struct Problem {
    at: UnitPoint,
    /// Change of every error per coordinate.
    jacobian: DMatrix<f64>,
    weights: DVector<f64>,
    errors: DVector<f64>,
    /// Where the loss of an error turns from its square to its size.
    width: f64,
    /// Median and variance of every coordinate beforehand.
    prior: Vec<Option<(f64, f64)>>,
    /// Loss per square of a spread of the prior.
    prior_share: f64,
    correlation: f64,
}

/// Loss of one error: its square near 0, its size beyond (Charbonnier's).
fn loss_of(error: f64, width: f64) -> f64 {
    let ratio = error / width;
    width * width * ((1.0 + ratio * ratio).sqrt() - 1.0)
}

fn weight(error: f64, width: f64) -> f64 {
    1.0 / (1.0 + (error / width).powi(2)).sqrt()
}

/// How many errors in a row say the same: 1 + 2 times the autocorrelations up to the first that is not positive (Geyer 1992).
fn correlation(errors: &DVector<f64>) -> f64 {
    let count = errors.len();
    let mean = errors.mean();
    let product = |lag: usize| -> f64 {
        let pairs = errors.iter().zip(errors.iter().skip(lag));
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    let variance = product(0);
    if variance <= 0.0 {
        return 1.0;
    }
    let mut sum = 1.0;
    for lag in 1..count / 4 {
        let share = product(lag) / variance;
        // Twice the standard error of an autocorrelation that is none.
        if share < 2.0 / (count as f64).sqrt() {
            break;
        }
        sum += 2.0 * share;
    }
    sum
}

/// How much prior knowledge of this variance tells of a coordinate; without any, what the range says: evenly spread from 0 to 1.
fn precision(variance: Option<f64>) -> f64 {
    variance.map_or(12.0, |variance| 1.0 / variance)
}

/// Change of every error per coordinate, a row an error: from errors at a point and at those moved from there by one coordinate
/// each. A coordinate whose errors are not known, or not as many, tells nothing.
pub fn slopes<'a>(
    at: &UnitPoint,
    errors: &[f64],
    moved: impl Iterator<Item = (&'a UnitPoint, Option<&'a [f64]>)>,
) -> DMatrix<f64> {
    let mut jacobian = DMatrix::zeros(errors.len(), at.len());
    for (axis, (point, after)) in moved.enumerate() {
        let Some(after) = after.filter(|after| after.len() == errors.len()) else {
            continue;
        };
        let step = point[axis] - at[axis];
        for (row, (after, before)) in after.iter().zip(errors).enumerate() {
            jacobian[(row, axis)] = (after - before) / step;
        }
    }
    jacobian
}

impl Quadratic {
    /// What prior knowledge tells of each coordinate by itself: its part of the information.
    pub fn prior_information(&self) -> DVector<f64> {
        let precisions = self.prior.iter().map(|variance| precision(*variance));
        DVector::from_iterator(self.prior.len(), precisions)
    }
}

impl Problem {
    /// The problem at a point; a coordinate whose shifted errors are not known stays where it is.
    pub fn new(
        at: &UnitPoint,
        errors: &[f64],
        brief: &OptimizationProblem,
        moved: &[UnitPoint],
        shifted: &[Option<&[f64]>],
    ) -> Self {
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // The median size: between least squares and least sizes, whatever the unit.
        let width = sizes[sizes.len() / 2].max(1e-12);
        let jacobian = slopes(at, errors, moved.iter().zip(shifted.iter().copied()));
        let errors = DVector::from_column_slice(errors);
        let correlation = correlation(&errors);
        let variance = errors.map(|e| weight(e, width) * e * e).mean();
        let mut prior = brief.priors.clone();
        prior.resize(at.len(), None);
        Self {
            at: at.clone(),
            weights: errors.map(|error| weight(error, width)),
            prior,
            prior_share: variance * correlation,
            jacobian,
            errors,
            width,
            correlation,
        }
    }

    /// The robust loss of these errors at a point, prior knowledge included.
    pub fn loss(&self, point: &UnitPoint, errors: &[f64]) -> f64 {
        let errors: f64 = errors.iter().map(|e| loss_of(*e, self.width)).sum();
        let prior = self.prior.iter().zip(point);
        let prior: f64 = prior
            .filter_map(|(prior, c)| prior.map(|(median, v)| (c - median).powi(2) / v))
            .sum();
        errors + 0.5 * self.prior_share * prior
    }

    /// The loss where the problem was made.
    pub fn here(&self) -> f64 {
        self.loss(&self.at, self.errors.as_slice())
    }

    /// How many errors there are.
    pub fn errors(&self) -> usize {
        self.errors.len()
    }

    /// Curvature and slope of the loss, prior knowledge included.
    fn normal(&self) -> (DMatrix<f64>, DVector<f64>) {
        let mut weighted = self.jacobian.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(self.weights.iter()) {
            row *= *weight;
        }
        let mut curvature = weighted.tr_mul(&self.jacobian);
        let mut slope = weighted.tr_mul(&self.errors);
        for (axis, prior) in self.prior.iter().enumerate() {
            if let Some((median, variance)) = prior {
                curvature[(axis, axis)] += self.prior_share / variance;
                slope[axis] += self.prior_share * (self.at[axis] - median) / variance;
            }
        }
        (curvature, slope)
    }

    /// Where a damped step leads; it ends at the bounds, and a coordinate that it would push beyond one stays there.
    pub fn step(&self, point: &UnitPoint, damping: f64) -> UnitPoint {
        let (curvature, slope) = self.normal();
        let mut held: Vec<bool> = curvature.diagonal().iter().map(|d| *d <= 0.0).collect();
        let mut to = point.clone();
        // Each round holds at least one coordinate more.
        for _ in 0..=point.len() {
            let free: Vec<usize> = (0..point.len()).filter(|axis| !held[*axis]).collect();
            let matrix = DMatrix::from_fn(free.len(), free.len(), |row, column| {
                let damped = if row == column { 1.0 + damping } else { 1.0 };
                damped * curvature[(free[row], free[column])]
            });
            let right = DVector::from_fn(free.len(), |row, _| {
                let moved: f64 = (0..point.len())
                    .filter(|axis| held[*axis])
                    .map(|axis| curvature[(free[row], axis)] * (to[axis] - point[axis]))
                    .sum();
                -slope[free[row]] - moved
            });
            let steps = solve(matrix, &right);
            let mut is_within = true;
            for (axis, step) in free.iter().zip(steps.iter()) {
                let target = point[*axis] + step;
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

    /// By how much the loss falls on the way to a point if errors are as straight as they seem.
    pub fn gain(&self, point: &UnitPoint, to: &UnitPoint) -> f64 {
        let step = DVector::from_fn(point.len(), |axis, _| to[axis] - point[axis]);
        let (curvature, slope) = self.normal();
        -slope.dot(&step) - 0.5 * step.dot(&(curvature * &step))
    }

    /// What is known here: variances of robust estimates (Huber 1981, section 7.6), errors in a row counted once, or from three
    /// logs on how far they disagree. `least`: the point with the least loss that was simulated; `told`: as [`Quadratic::told`].
    pub fn quadratic(
        &self,
        least: (UnitPoint, f64),
        told: (usize, usize),
        logs: &[usize],
    ) -> Quadratic {
        let count = self.errors.len() as f64;
        let dimensions = self.at.len();
        let squares = self.errors.zip_map(&self.weights, |e, w| (w * e).powi(2));
        let slopes = self.weights.map(|w| w.powi(3));
        let slope = slopes.mean();
        let free = (count - dimensions as f64).max(1.0);
        let few = 1.0 + dimensions as f64 / count * slopes.variance() / slope.powi(2);
        let noise = squares.sum() / free * (few / slope).powi(2) * self.correlation;
        let noise = noise.max(f64::MIN_POSITIVE);
        let mut information = self.jacobian.tr_mul(&self.jacobian) / noise;
        let priors = self.prior.iter();
        let priors = priors.map(|prior| precision(prior.map(|(_, variance)| variance)));
        let prior = DVector::from_iterator(dimensions, priors);
        information += DMatrix::from_diagonal(&prior);
        let covariance = match information.cholesky() {
            Some(cholesky) => cholesky.inverse(),
            None => DMatrix::identity(dimensions, dimensions) / precision(None),
        };
        let weighted = self.weights.iter().zip(self.errors.iter());
        let lean = Lean {
            jacobian: &self.jacobian,
            loss: weighted
                .map(|(w, e)| (w.powi(3) / slope, w * e / slope))
                .collect(),
            prior: &prior,
            logs,
        };
        let covariance = lean.widened(covariance, noise);
        let rows = covariance.row_iter();
        Quadratic {
            at: least.0,
            loss: least.1,
            told,
            noise,
            point: self.step(&self.at, 0.0),
            covariance: rows.map(|row| row.iter().copied().collect()).collect(),
            prior: self.prior.iter().map(|p| p.map(|(_, v)| v)).collect(),
            correlation: self.correlation,
            error: (self.errors.norm_squared() / count).sqrt(),
        }
    }
}
