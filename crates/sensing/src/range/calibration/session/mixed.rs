//! The restricted likelihood of a mixed model with random effects of sessions.

use nalgebra::{DMatrix, DVector};

use super::super::fit::{factor, scaled_by};
use super::Spread;
use realgap_core::statistics::mean;

/// With more cells than this, the degrees of freedom are those of the sessions alone, because the cost of the exact ones grows with
/// the cube of the number of cells.
const MOST_CELLS: usize = 600;
/// Critical value, at a level of 1 %, of −2 times the logarithm of the likelihood ratio for one more parameter (Wilks 1938).
const CLEAR: f64 = 6.63;

/// The data of the mixed model: residuals, gradients and weights of the random effects of all cells.
pub(super) struct Mixed {
    /// Residuals of the cells' means from the curve.
    pub residual: DVector<f64>,
    /// Gradients of the curve.
    pub gradient: DMatrix<f64>,
    /// Variance of the cells' means within their session.
    pub within: Vec<f64>,
    /// Index of the session of each cell.
    pub session: Vec<usize>,
    /// Number of sessions.
    pub sessions: usize,
    /// Weight w of each cell in the effect that a session has at all distances.
    pub everywhere: Vec<f64>,
    /// Weight u of each cell in the effect that a session has at each distance separately.
    pub by_distance: Vec<f64>,
    /// Whether w and u grow with the mean reading.
    pub grow: [bool; 2],
    /// Mean of the absolute values of all mean readings.
    pub usual: f64,
}

/// The solution at given variances.
pub(super) struct Solved {
    /// −2 times the restricted log-likelihood, up to a constant.
    pub deviance: f64,
    pub step: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

impl Mixed {
    /// V⁻¹ times the columns of a matrix, and ln |V|. For each session V is a diagonal matrix plus one of rank one (Sherman & Morrison
    /// 1950).
    fn weigh(&self, [a, c]: [f64; 2], of: &DMatrix<f64>) -> (DMatrix<f64>, f64) {
        let diagonal: Vec<f64> = (0..self.within.len())
            .map(|k| self.within[k] + c * self.by_distance[k].powi(2))
            .collect();
        let mut weighed = of.clone();
        for (k, d) in diagonal.iter().enumerate() {
            weighed.row_mut(k).scale_mut(1.0 / d);
        }
        let mut log_determinant: f64 = diagonal.iter().map(|d| libm::log(*d)).sum();
        let mut size = vec![0.0; self.sessions];
        let mut sums = DMatrix::<f64>::zeros(self.sessions, of.ncols());
        for k in 0..diagonal.len() {
            let s = self.session[k];
            size[s] += self.everywhere[k].powi(2) / diagonal[k];
            for column in 0..of.ncols() {
                sums[(s, column)] += self.everywhere[k] * weighed[(k, column)];
            }
        }
        for k in 0..diagonal.len() {
            let s = self.session[k];
            let factor = a * self.everywhere[k] / (diagonal[k] * (1.0 + a * size[s]));
            for column in 0..of.ncols() {
                weighed[(k, column)] -= factor * sums[(s, column)];
            }
        }
        log_determinant += size.iter().map(|q| libm::log(1.0 + a * q)).sum::<f64>();
        (weighed, log_determinant)
    }

    pub(super) fn solve(&self, variances: [f64; 2]) -> Option<Solved> {
        let columns = self.gradient.ncols();
        let mut all = self.gradient.clone().insert_column(columns, 0.0);
        all.set_column(columns, &self.residual);
        let (weighed, log_determinant) = self.weigh(variances, &all);
        let products = self.gradient.transpose() * &weighed;
        let (factor, scale) = factor(&products)?;
        let information = 2.0
            * factor
                .l()
                .diagonal()
                .iter()
                .map(|v| libm::log(*v))
                .sum::<f64>();
        let covariance = scaled_by(&factor.inverse(), &scale);
        let right = products.column(columns).into_owned();
        let step = &covariance * &right;
        let squares = self.residual.dot(&weighed.column(columns)) - right.dot(&step);
        let scales: f64 = scale.iter().map(|s| 2.0 * libm::log(*s)).sum();
        Some(Solved {
            deviance: log_determinant + information + scales + squares,
            step,
            covariance,
        })
    }

    /// The variances with the smallest deviance, by nested golden-section searches over the standard deviations.
    pub(super) fn variances(&self, most: f64) -> [f64; 2] {
        let deviance = |sds: [f64; 2]| {
            let solved = self.solve([sds[0] * sds[0], sds[1] * sds[1]]);
            solved.map_or(f64::INFINITY, |s| s.deviance)
        };
        let inner = |a: f64| golden(most, &|c| deviance([a, c]));
        let a = golden(most, &|a| deviance([a, inner(a)]));
        let c = inner(a);
        [a * a, c * c]
    }

    /// Expected covariance of the two variances: the inverse of ½ tr(P Vᵢ P Vⱼ).
    pub(super) fn variance_covariance(
        &self,
        variances: [f64; 2],
        solved: &Solved,
    ) -> Option<DMatrix<f64>> {
        let cells = self.within.len();
        if cells > MOST_CELLS {
            return None;
        }
        let (inverse, _) = self.weigh(variances, &DMatrix::identity(cells, cells));
        let weighed = &inverse * &self.gradient;
        let p = &inverse - &weighed * &solved.covariance * weighed.transpose();
        // P times the derivatives of V with respect to the two variances: one has a block for each session, the other is diagonal.
        let mut sums = DMatrix::<f64>::zeros(cells, self.sessions);
        for k in 0..cells {
            for row in 0..cells {
                sums[(row, self.session[k])] += p[(row, k)] * self.everywhere[k];
            }
        }
        let by_session = DMatrix::from_fn(cells, cells, |i, k| {
            sums[(i, self.session[k])] * self.everywhere[k]
        });
        let by_cell =
            DMatrix::from_fn(cells, cells, |i, k| p[(i, k)] * self.by_distance[k].powi(2));
        let parts = [&by_session, &by_cell];
        let information = DMatrix::from_fn(2, 2, |i, j| {
            0.5 * parts[i].component_mul(&parts[j].transpose()).sum()
        });
        information.try_inverse()
    }

    /// Satterthwaite's degrees of freedom of a variance that is a function of the two variances.
    pub(super) fn degrees(
        &self,
        variances: [f64; 2],
        covariance: Option<&DMatrix<f64>>,
        of: impl Fn([f64; 2]) -> Option<f64>,
    ) -> f64 {
        let few = (self.sessions - 1) as f64;
        let most = (self.within.len() - self.gradient.ncols()).max(1) as f64;
        let found = || -> Option<f64> {
            let value = of(variances)?;
            let scale = variances[0] + variances[1] + mean(&self.within);
            let slope: Option<Vec<f64>> = (0..2)
                .map(|i| {
                    let mut moved = variances;
                    moved[i] += 1e-4 * scale;
                    Some((of(moved)? - value) / (1e-4 * scale))
                })
                .collect();
            let slope = DVector::from_vec(slope?);
            let variance = (slope.transpose() * covariance? * &slope)[(0, 0)];
            let degrees = 2.0 * value * value / variance;
            degrees.is_finite().then_some(degrees)
        };
        found().map_or(few, |degrees| degrees.clamp(few.min(most), most))
    }
}

/// The minimum between 0 and `most` of a function with one minimum, to a thousandth of `most`, by golden-section search.
fn golden(most: f64, of: &dyn Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (0.0, most);
    let (mut left, mut right) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_left, mut at_right) = (of(left), of(right));
    for _ in 0..14 {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = of(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = of(right);
        }
    }
    let found = 0.5 * (low + high);
    if of(0.0) <= of(found) { 0.0 } else { found }
}

impl Mixed {
    /// The deviance plus a penalty for each effect that is an error of scale instead of a constant offset.
    pub(super) fn penalised_deviance(&self, solved: &Solved) -> f64 {
        let grow = self.grow.iter().filter(|grows| **grows).count();
        solved.deviance + CLEAR * grow as f64
    }

    pub(super) fn spread(&self, which: usize, variance: f64, (low, high): (f64, f64)) -> Spread {
        let sd = variance.sqrt();
        Spread {
            sd,
            low,
            high,
            grows_with_reading: self.grow[which],
            share: if self.grow[which] {
                sd / self.usual
            } else {
                0.0
            },
        }
    }
}
