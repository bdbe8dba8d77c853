//! The linearised least-squares problem at a point, its damped steps, and the covariance of its solution.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::super::{OptimizationProblem, UnitPoint};
use super::log::LogErrors;
use super::solve;

/// Quadratic approximation of the loss (errors and priors together) near its minimum, in coordinates from 0 to 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quadratic {
    /// The point with the smallest robust loss of all simulated points.
    pub at: UnitPoint,
    /// The robust loss at [`Self::at`].
    pub loss: f64,
    /// Index in the history of the best point that has finite differences around it, and index of the first of the points of these
    /// differences, one for each coordinate.
    #[serde(rename = "told")]
    pub indices: (usize, usize),
    /// Variance of an error at [`Self::at`], if all errors are treated as independent.
    pub noise: f64,
    /// The minimum of the quadratic approximation.
    pub point: UnitPoint,
    /// Covariance of [`Self::point`], row by row. With three or more logs it includes the disagreement between logs (a jackknife
    /// over logs), scaled so that ±1.645 standard deviations contain 90 %. With fewer logs it includes the noise of the errors only,
    /// not errors of the model.
    pub covariance: Vec<Vec<f64>>,
    /// Variance of every coordinate according to its prior alone; `None` if only the range is known.
    pub prior: Vec<Option<f64>>,
    /// Correlation length of the errors: how many consecutive errors contain as much information as one independent error.
    pub correlation: f64,
    /// Root mean square of the errors.
    pub error: f64,
}

/// Errors at a point and their derivatives with respect to every coordinate.
#[derive(Clone)]
pub(super) struct LinearisedProblem {
    at: UnitPoint,
    /// Change of every error per coordinate.
    jacobian: DMatrix<f64>,
    weights: DVector<f64>,
    errors: DVector<f64>,
    /// Size of an error at which its loss changes from quadratic to linear.
    width: f64,
    /// Median and variance of the prior of every coordinate.
    prior: Vec<Option<(f64, f64)>>,
    /// Weight of the prior in the loss: twice the loss of a coordinate that is one standard deviation from its median.
    prior_share: f64,
    correlation: f64,
}

/// Charbonnier loss of one error: quadratic for errors below the width, linear for larger errors.
fn loss_of(error: f64, width: f64) -> f64 {
    let ratio = error / width;
    width * width * ((1.0 + ratio * ratio).sqrt() - 1.0)
}

/// Weight of one error in iteratively reweighted least squares.
fn weight(error: f64, width: f64) -> f64 {
    1.0 / (1.0 + (error / width).powi(2)).sqrt()
}

/// Number of consecutive errors that contain as much information as one independent error: 1 + 2 times the sum of the
/// autocorrelations up to the first one that is not significantly positive (Geyer 1992).
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
        // The limit is twice the standard error of the autocorrelation of independent errors.
        if share < 2.0 / (count as f64).sqrt() {
            break;
        }
        sum += 2.0 * share;
    }
    sum
}

/// Precision of a prior with this variance; without a prior, the precision of a uniform distribution from 0 to 1, which is 12.
fn precision(variance: Option<f64>) -> f64 {
    variance.map_or(12.0, |variance| 1.0 / variance)
}

/// Jacobian of the errors, with one row for each error and one column for each coordinate, by finite differences between a point and
/// the points that are moved along one coordinate each. The column of a coordinate is zero if the errors of its moved point are
/// unknown or differ in number.
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
    /// The information of the prior about each coordinate: its precision.
    pub fn prior_information(&self) -> DVector<f64> {
        let precisions = self.prior.iter().map(|variance| precision(*variance));
        DVector::from_iterator(self.prior.len(), precisions)
    }
}

impl LinearisedProblem {
    /// The linearised problem at a point. A coordinate whose shifted errors are unknown is not moved by steps.
    pub fn new(
        at: &UnitPoint,
        errors: &[f64],
        problem: &OptimizationProblem,
        moved: &[UnitPoint],
        shifted: &[Option<&[f64]>],
    ) -> Self {
        let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // The width is the median absolute error, so that the loss is between least squares and least absolute deviations in
        // any unit.
        let width = sizes[sizes.len() / 2].max(1e-12);
        let jacobian = slopes(at, errors, moved.iter().zip(shifted.iter().copied()));
        let errors = DVector::from_column_slice(errors);
        let correlation = correlation(&errors);
        let variance = errors.map(|e| weight(e, width) * e * e).mean();
        let mut prior = problem.priors.clone();
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

    /// The robust loss of these errors at a point, including the priors.
    pub fn loss(&self, point: &UnitPoint, errors: &[f64]) -> f64 {
        let errors: f64 = errors.iter().map(|e| loss_of(*e, self.width)).sum();
        let prior = self.prior.iter().zip(point);
        let prior: f64 = prior
            .filter_map(|(prior, c)| prior.map(|(median, v)| (c - median).powi(2) / v))
            .sum();
        errors + 0.5 * self.prior_share * prior
    }

    /// The loss at the point at which the problem was linearised.
    pub(crate) fn loss_here(&self) -> f64 {
        self.loss(&self.at, self.errors.as_slice())
    }

    /// Number of errors.
    pub fn errors(&self) -> usize {
        self.errors.len()
    }

    /// Approximate Hessian and gradient of the loss, including the priors.
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

    /// The end point of a damped step. A coordinate that the step would move beyond a bound is set to that bound, and the step of
    /// the others is computed again.
    pub fn step(&self, point: &UnitPoint, damping: f64) -> UnitPoint {
        let (curvature, slope) = self.normal();
        let mut held: Vec<bool> = curvature.diagonal().iter().map(|d| *d <= 0.0).collect();
        let mut to = point.clone();
        // Each round fixes at least one more coordinate at a bound.
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

    /// Decrease of the loss on the way to a point that the quadratic approximation predicts.
    pub fn gain(&self, point: &UnitPoint, to: &UnitPoint) -> f64 {
        let step = DVector::from_fn(point.len(), |axis, _| to[axis] - point[axis]);
        let (curvature, slope) = self.normal();
        -slope.dot(&step) - 0.5 * step.dot(&(curvature * &step))
    }

    /// The quadratic approximation of the loss. Its covariance is that of robust estimates (Huber 1981, section 7.6), corrected for
    /// correlation of consecutive errors or, with three or more logs, for the disagreement between logs. `least` is the simulated
    /// point with the smallest loss, with that loss; for `indices`, see [`Quadratic::indices`].
    pub fn quadratic(
        &self,
        least: (UnitPoint, f64),
        indices: (usize, usize),
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
        let log_errors = LogErrors {
            jacobian: &self.jacobian,
            loss: weighted
                .map(|(w, e)| (w.powi(3) / slope, w * e / slope))
                .collect(),
            prior: &prior,
            logs,
        };
        let covariance = log_errors.widened(covariance, noise);
        let rows = covariance.row_iter();
        Quadratic {
            at: least.0,
            loss: least.1,
            indices,
            noise,
            point: self.step(&self.at, 0.0),
            covariance: rows.map(|row| row.iter().copied().collect()).collect(),
            prior: self.prior.iter().map(|p| p.map(|(_, v)| v)).collect(),
            correlation: self.correlation,
            error: (self.errors.norm_squared() / count).sqrt(),
        }
    }
}
