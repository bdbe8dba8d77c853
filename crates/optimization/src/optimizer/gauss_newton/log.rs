//! What logs say against each other: where a model lacks something, errors do not scatter but lean, another way in every log.

use nalgebra::{DMatrix, DVector};
use realgap_core::statistics::{jackknife_variance, student_quantile};

use super::solve;

/// Half of a 90 % interval in standard deviations of a normal distribution, as the readers of a covariance take it.
const NINETY: f64 = 1.644_853_626_951;
/// With fewer logs than this, noise is all that can be told.
const FEWEST: usize = 3;

/// The errors at a point, one row each.
pub(super) struct Lean<'a> {
    /// Change of every error per coordinate.
    pub jacobian: &'a DMatrix<f64>,
    /// Curvature of every error's loss, and its slope.
    pub loss: Vec<(f64, f64)>,
    /// What is known of every coordinate beforehand: one over its variance.
    pub prior: &'a DVector<f64>,
    /// How many of the errors each log has.
    pub logs: &'a [usize],
}

impl Lean<'_> {
    /// A covariance of noise with the variances that leaving out one log after the other shows (Tukey 1958), each by one linear step
    /// and with Student's width for as many logs as there are; what the prior adds stays. Correlations are kept.
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
