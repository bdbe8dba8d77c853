//! A Gaussian process conditioned on values (Rasmussen & Williams 2006, algorithm 2.1), with a known or an estimated mean.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Factorises the covariance of `count` values. `covariance` gives its entries by row and column (only the lower triangle is asked
/// for), `noise` is added to the diagonal. `None` where the matrix is not positive definite.
pub fn factorise(
    count: usize,
    covariance: impl Fn(usize, usize) -> f64,
    noise: f64,
) -> Option<Cholesky<f64, Dyn>> {
    let mut matrix = DMatrix::zeros(count, count);
    for column in 0..count {
        for row in column..count {
            matrix[(row, column)] = covariance(row, column);
        }
        matrix[(column, column)] += noise;
    }
    Cholesky::new(matrix)
}

/// What is assumed about the mean of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mean {
    /// The mean is zero.
    Zero,
    /// The mean is an unknown constant, which is estimated by generalised least squares (ordinary kriging; Cressie 1993, section 3.2).
    Estimated,
}

/// The estimated constant mean of a process.
#[derive(Debug, Clone)]
struct EstimatedMean {
    value: f64,
    /// Variance of the estimate.
    variance: f64,
    /// Share of each value in the estimate. Where values lie close together each of them has a small share, so that many good values
    /// at one place do not raise the expectation everywhere.
    shares: DVector<f64>,
}

/// A Gaussian process conditioned on values.
#[derive(Debug, Clone)]
pub struct ConditionedProcess {
    factor: Cholesky<f64, Dyn>,
    mean: Option<EstimatedMean>,
    /// Inverse covariance times the values' residuals about the mean.
    weights: DVector<f64>,
    deviance: f64,
}

/// What a conditioned process predicts for several points jointly.
#[derive(Debug, Clone)]
pub struct JointPrediction {
    /// Expected values.
    pub means: DVector<f64>,
    /// Covariance of the values that the conditioning leaves, uncertainty of the mean included.
    pub covariance: DMatrix<f64>,
    /// Weight of each known value (column) in each expected value (row).
    pub weights: DMatrix<f64>,
}

impl ConditionedProcess {
    /// Conditions a process on values, whose covariance is factorised (see [`factorise`]).
    pub fn new(factor: Cholesky<f64, Dyn>, values: &DVector<f64>, mean: Mean) -> Self {
        let (mean, residuals) = match mean {
            Mean::Zero => (None, values.clone()),
            Mean::Estimated => {
                let solved = factor.solve(&DVector::repeat(values.len(), 1.0));
                let sum = solved.sum();
                let shares = solved / sum;
                let value = shares.dot(values);
                let residuals = values.add_scalar(-value);
                let variance = sum.recip();
                let mean = EstimatedMean {
                    value,
                    variance,
                    shares,
                };
                (Some(mean), residuals)
            }
        };
        let weights = factor.solve(&residuals);
        let half_log_determinant = factor.l_dirty().diagonal().map(libm::log).sum();
        Self {
            deviance: residuals.dot(&weights) + 2.0 * half_log_determinant,
            factor,
            mean,
            weights,
        }
    }

    /// Minus twice the logarithm of the likelihood of the values, without the constant n ln 2π.
    pub fn deviance(&self) -> f64 {
        self.deviance
    }

    /// Inverse covariance times the values' residuals about the mean.
    pub fn weights(&self) -> &DVector<f64> {
        &self.weights
    }

    /// Inverse covariance of the values times a matrix.
    pub fn solve(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        self.factor.solve(matrix)
    }

    /// Inverse of the values' covariance.
    pub(super) fn inverse_covariance(&self) -> DMatrix<f64> {
        let n = self.weights.len();
        let mut half = DMatrix::identity(n, n);
        self.factor.l_dirty().solve_lower_triangular_mut(&mut half);
        half.tr_mul(&half)
    }

    /// Expected value at a point that has these covariances with the known values.
    pub fn mean(&self, across: &DVector<f64>) -> f64 {
        let beyond = across.dot(&self.weights);
        match &self.mean {
            None => beyond,
            Some(mean) => mean.value + beyond,
        }
    }

    /// Standard deviation at a point that has these covariances with the known values and this variance before conditioning; the
    /// uncertainty of an estimated mean is not part of it.
    pub(super) fn deviation(&self, mut across: DVector<f64>, prior_variance: f64) -> f64 {
        self.factor
            .l_dirty()
            .solve_lower_triangular_mut(&mut across);
        let variance = prior_variance - across.norm_squared();
        variance.max(0.0).sqrt()
    }

    /// Joint prediction for several points. `across` holds the covariances of the known values (rows) with the points (columns),
    /// `prior` the covariance of the points before conditioning.
    pub fn predict(&self, across: &DMatrix<f64>, prior: &DMatrix<f64>) -> JointPrediction {
        let known = self.solve(across);
        let means = across.tr_mul(&self.weights);
        let covariance = prior - known.tr_mul(across);
        let Some(mean) = &self.mean else {
            return JointPrediction {
                means,
                covariance,
                weights: known.transpose(),
            };
        };
        // The part of an expected value that the known values do not carry comes from the estimated mean, with its uncertainty.
        let columns = across.ncols();
        let unexplained = DVector::from_fn(columns, |point, _| 1.0 - known.column(point).sum());
        JointPrediction {
            means: means.add_scalar(mean.value),
            covariance: covariance + &unexplained * unexplained.transpose() * mean.variance,
            weights: known.transpose() + &unexplained * mean.shares.transpose(),
        }
    }
}
