//! The linearised least-squares problem at a point, and its damped steps.

use nalgebra::{DMatrix, DVector};

use super::super::{OptimizationProblem, UnitPoint};
use super::bounded::minimum_within;
use super::channel::{blocks_of, error_scales};
use super::robust::{robust_loss, robust_weight};

/// The errors at a point and their derivatives with respect to every coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// The point.
    pub at: UnitPoint,
    /// The errors there.
    pub errors: Vec<f64>,
    /// Change of every error (row) per coordinate (column).
    pub jacobian: DMatrix<f64>,
    /// Size of a typical error of each error's channel, positive. The loss of an error changes from quadratic to linear there.
    pub scales: Vec<f64>,
    /// Index in the history of the point around which the derivatives were taken (this one, or one that is nearer to it than the step
    /// at which a descent ends), and of the first of the points that are moved from there along one coordinate each.
    pub indices: (usize, usize),
}

/// Errors at a point, in typical errors of their channels, and their derivatives with respect to every coordinate.
#[derive(Clone)]
pub(super) struct LinearisedProblem {
    at: UnitPoint,
    /// Change of every error per coordinate.
    jacobian: DMatrix<f64>,
    weights: DVector<f64>,
    errors: DVector<f64>,
    /// Size of a typical error of each error's channel.
    scales: Vec<f64>,
    /// Median and variance of the prior of every coordinate.
    prior: Vec<Option<(f64, f64)>>,
    /// Weight of the prior in the loss: twice the loss of a coordinate that is one standard deviation from its median.
    prior_share: f64,
    /// Approximate Hessian and gradient of the loss, including the priors; a few steps ask for them, and many errors make them dear.
    normal: (DMatrix<f64>, DVector<f64>),
}

/// Standard deviation of the weak prior that a step has around the point where it begins, as a share of each range.
const STEP_DEVIATION: f64 = 0.5;

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

impl LinearisedProblem {
    /// The linearised problem at a point. A coordinate whose shifted errors are unknown is not moved by steps.
    pub fn new(
        at: &UnitPoint,
        errors: &[f64],
        problem: &OptimizationProblem,
        moved: &[UnitPoint],
        shifted: &[Option<&[f64]>],
    ) -> Self {
        // The scale of each channel is its median absolute error, so that the loss is between least squares and least absolute
        // deviations in any unit, and a channel with small errors counts as much as one with large errors.
        let scales = error_scales(&blocks_of(&problem.error_blocks, errors.len()), errors);
        let scaled = |errors: &[f64]| -> Vec<f64> {
            errors.iter().zip(&scales).map(|(e, s)| e / s).collect()
        };
        let shifted: Vec<Option<Vec<f64>>> = shifted
            .iter()
            .map(|shifted| shifted.filter(|s| s.len() == errors.len()).map(scaled))
            .collect();
        let errors = scaled(errors);
        let shifted = shifted.iter().map(|shifted| shifted.as_deref());
        let jacobian = slopes(at, &errors, moved.iter().zip(shifted));
        let errors = DVector::from_vec(errors);
        let variance = errors.map(|e| robust_weight(e) * e * e).mean();
        let mut prior = problem.priors.clone();
        prior.resize(at.len(), None);
        let mut linearised = Self {
            at: at.clone(),
            normal: (DMatrix::zeros(0, 0), DVector::zeros(0)),
            weights: errors.map(robust_weight),
            prior,
            prior_share: variance * correlation(&errors),
            jacobian,
            errors,
            scales,
        };
        linearised.normal = linearised.normal_equations();
        linearised
    }

    /// The robust loss of these errors at a point, including the priors.
    pub fn loss(&self, point: &UnitPoint, errors: &[f64]) -> f64 {
        let errors = errors.iter().zip(&self.scales);
        let errors: f64 = errors
            .map(|(error, scale)| robust_loss(error / scale))
            .sum();
        let prior = self.prior.iter().zip(point);
        let prior: f64 = prior
            .filter_map(|(prior, c)| prior.map(|(median, v)| (c - median).powi(2) / v))
            .sum();
        errors + 0.5 * self.prior_share * prior
    }

    /// The loss at the point at which the problem was linearised.
    pub(crate) fn loss_here(&self) -> f64 {
        let errors = self.errors.iter().zip(&self.scales);
        let errors: Vec<f64> = errors.map(|(error, scale)| error * scale).collect();
        self.loss(&self.at, &errors)
    }

    /// Size of a typical error of each error's channel.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Approximate Hessian and gradient of the loss, including the priors.
    fn normal_equations(&self) -> (DMatrix<f64>, DVector<f64>) {
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
    ///
    /// Marquardt's damping is in proportion to each coordinate's own curvature, so that alone it lets a coordinate that hardly acts
    /// here go to its bound, where it may act: a joint that dry friction holds would break loose in every step. So the point itself
    /// counts as a weak prior of the step: a coordinate moves far only if the errors tell more of it than such a prior does.
    pub fn step(&self, point: &UnitPoint, damping: f64) -> UnitPoint {
        let (mut curvature, slope) = self.normal.clone();
        let own = curvature.diagonal();
        let held = own.iter().map(|d| *d <= 0.0).collect();
        let stays = self.prior_share / STEP_DEVIATION.powi(2);
        for axis in 0..point.len() {
            curvature[(axis, axis)] += stays + damping * (own[axis] + stays);
        }
        minimum_within(&curvature, &slope, point, held)
    }

    /// Decrease of the loss on the way to a point that the quadratic approximation predicts.
    pub fn gain(&self, point: &UnitPoint, to: &UnitPoint) -> f64 {
        let step = DVector::from_fn(point.len(), |axis, _| to[axis] - point[axis]);
        let (curvature, slope) = &self.normal;
        -slope.dot(&step) - 0.5 * step.dot(&(curvature * &step))
    }
}
