//! Widens the covariance of a fit by the disagreement between logs.
//!
//! If a model lacks an effect, the errors within one log do not scatter randomly but share a bias that differs between logs. The
//! noise of single errors then underestimates the uncertainty of the fit.

use nalgebra::{DMatrix, DVector};
use realgap_core::statistics::{jackknife_variance, student_quantile};

use super::solve;

/// Half of a 90 % interval of a normal distribution, in standard deviations.
const NINETY: f64 = 1.644_853_626_951;
/// With fewer logs than this, their disagreement cannot be estimated, and only the noise is used.
const FEWEST: usize = 3;

/// The linearised errors at a point, grouped by log.
pub(super) struct LogErrors<'a> {
    /// Change of every error per coordinate.
    pub jacobian: &'a DMatrix<f64>,
    /// Second and first derivative of the loss of every error.
    pub loss: Vec<(f64, f64)>,
    /// Prior precision of every coordinate: one divided by its variance.
    pub prior: &'a DVector<f64>,
    /// Number of errors of each log.
    pub logs: &'a [usize],
}

impl LogErrors<'_> {
    /// The covariance that is due to noise, with each variance replaced by the jackknife variance of leaving out one log after the
    /// other (Tukey 1958). Each fit without a log is one linear step, and the widths follow Student's distribution for the number
    /// of logs. The share of the variance that is due to the prior is added, and correlations are kept.
    pub fn widened(&self, covariance: DMatrix<f64>, noise: f64) -> DMatrix<f64> {
        if self.logs.len() < FEWEST || self.logs.iter().sum::<usize>() != self.loss.len() {
            return covariance;
        }
        let (mut first, mut parts) = (0, Vec::new());
        for count in self.logs {
            let own = self.jacobian.rows(first, *count);
            let loss = &self.loss[first..first + count];
            let slopes = DVector::from_iterator(*count, loss.iter().map(|(_, slope)| *slope));
            let mut curved = own.into_owned();
            for (mut row, (curvature, _)) in curved.row_iter_mut().zip(loss) {
                row *= *curvature;
            }
            parts.push((curved.tr_mul(&own), own.tr_mul(&slopes)));
            first += count;
        }
        let mut all = DMatrix::from_diagonal(&(self.prior * noise));
        parts.iter().for_each(|(part, _)| all += part);
        let shifts = parts.iter().map(|(part, pull)| solve(&all - part, pull));
        let shifts: Vec<DVector<f64>> = shifts.collect();
        let student = student_quantile(0.95, self.logs.len() as f64 - 1.0) / NINETY;
        let size = covariance.nrows();
        let factor = |axis: usize| {
            let left_out: Vec<f64> = shifts.iter().map(|shift| shift[axis]).collect();
            let row = covariance.row(axis);
            let prior: f64 = row
                .iter()
                .zip(self.prior.iter())
                .map(|(c, p)| c * c * p)
                .sum();
            let variance = jackknife_variance(&left_out) * student.powi(2) + prior;
            (variance / covariance[(axis, axis)]).sqrt()
        };
        let factors = DVector::from_fn(size, |axis, _| factor(axis));
        DMatrix::from_fn(size, size, |row, column| {
            covariance[(row, column)] * factors[row] * factors[column]
        })
    }
}
