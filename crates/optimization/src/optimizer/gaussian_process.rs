//! A Gaussian process with a Matérn 5/2 kernel, one length scale per axis, and noise
//! (Rasmussen & Williams 2006, algorithm 2.1 and equations 4.17, 5.8 and 5.9).

use std::f64::consts::{PI, SQRT_2};

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use realgap_core::statistics::matern_5_2;

/// How a function is believed to behave.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kernel {
    /// Distance along each axis over which values stay alike.
    pub lengths: Vec<f64>,
    /// Variance of the function about zero.
    pub variance: f64,
    /// Variance of a value about the function.
    pub noise: f64,
}

/// Where the logarithms of length scale, variance and noise are looked for; points lie in 0 to 1, values have variance 1.
const LENGTH: (f64, f64) = (0.02, 20.0);
const VARIANCE: (f64, f64) = (1e-2, 1e2);
const NOISE: (f64, f64) = (1e-8, 1.0);
/// Where the search for the likeliest kernel begins: length, variance, noise.
const STARTS: [(f64, f64, f64); 3] = [(0.3, 1.0, 1e-3), (1.0, 1.0, 0.1), (0.1, 1.0, 1e-2)];
/// Quasi-Newton steps from each start, and the slope below which one has arrived.
const STEPS: usize = 40;
const LEVEL: f64 = 1e-2;

impl Kernel {
    fn from_logarithms(logarithms: &[f64]) -> Self {
        let n = logarithms.len() - 2;
        let value = |index: usize| libm::exp(logarithms[index]);
        Self {
            lengths: (0..n).map(value).collect(),
            variance: value(n),
            noise: value(n + 1),
        }
    }

    /// Distance in length scales.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let axes = a.iter().zip(b).zip(&self.lengths);
        axes.map(|((a, b), length)| ((a - b) / length).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.variance * matern_5_2(self.distance(a, b))
    }
}

/// What is known about a function from noisy values of it.
pub(super) struct GaussianProcess<'a> {
    points: &'a [Vec<f64>],
    kernel: Kernel,
    /// Of the covariance of the values.
    factor: Cholesky<f64, Dyn>,
    /// Its inverse times the values.
    weights: DVector<f64>,
    /// Logarithm of the probability density of the values.
    log_likelihood: f64,
}

impl<'a> GaussianProcess<'a> {
    /// With a known kernel; the mean far from all points is zero. `None` where the covariance is singular.
    pub fn new(points: &'a [Vec<f64>], values: &[f64], kernel: Kernel) -> Option<Self> {
        let n = points.len();
        let mut covariance = DMatrix::zeros(n, n);
        for column in 0..n {
            for row in column..n {
                covariance[(row, column)] = kernel.covariance(&points[row], &points[column]);
            }
            covariance[(column, column)] += kernel.noise;
        }
        let factor = Cholesky::new(covariance)?;
        let values = DVector::from_column_slice(values);
        let weights = factor.solve(&values);
        let logs = factor.l_dirty().diagonal().map(libm::log).sum();
        let log_likelihood =
            -0.5 * values.dot(&weights) - logs - 0.5 * n as f64 * libm::log(2.0 * PI);
        Some(Self {
            points,
            kernel,
            factor,
            weights,
            log_likelihood,
        })
    }

    /// With the kernel that makes the values likeliest, found by ascent from three starts.
    pub fn fit(points: &'a [Vec<f64>], values: &[f64]) -> Option<Self> {
        let dimensions = points.first()?.len();
        let mut best: Option<Self> = None;
        for (length, variance, noise) in STARTS {
            let kernel = Kernel {
                lengths: vec![length; dimensions],
                variance,
                noise,
            };
            let Some(fitted) = Self::new(points, values, kernel).map(|s| s.ascend(values)) else {
                continue;
            };
            if (best.as_ref()).is_none_or(|best| fitted.log_likelihood > best.log_likelihood) {
                best = Some(fitted);
            }
        }
        best
    }

    pub fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// Mean and standard deviation of the function (not of a value of it, which has noise).
    pub fn predict(&self, point: &[f64]) -> (f64, f64) {
        let known = self.points.iter();
        let covariances = DVector::from_iterator(
            self.points.len(),
            known.map(|known| self.kernel.covariance(point, known)),
        );
        let mean = covariances.dot(&self.weights);
        let mut explained = covariances;
        self.factor
            .l_dirty()
            .solve_lower_triangular_mut(&mut explained);
        let variance = self.kernel.variance - explained.norm_squared();
        (mean, variance.max(0.0).sqrt())
    }

    /// Slope of the log likelihood along the logarithms of lengths, variance and noise.
    fn slope(&self) -> DVector<f64> {
        let (n, dimensions) = (self.points.len(), self.kernel.lengths.len());
        // ½ tr((α αᵀ − K⁻¹) ∂K), of which only the symmetric half is summed.
        let mut half = DMatrix::identity(n, n);
        self.factor.l_dirty().solve_lower_triangular_mut(&mut half);
        let inverse = half.tr_mul(&half);
        let mut slope = DVector::zeros(dimensions + 2);
        for column in 0..n {
            let on_diagonal = self.weights[column].powi(2) - inverse[(column, column)];
            slope[dimensions] += 0.5 * on_diagonal * self.kernel.variance;
            slope[dimensions + 1] += 0.5 * on_diagonal * self.kernel.noise;
            for row in column + 1..n {
                let weight = self.weights[row] * self.weights[column] - inverse[(row, column)];
                let (a, b) = (&self.points[row], &self.points[column]);
                let s = 5.0_f64.sqrt() * self.kernel.distance(a, b);
                let scale = weight * self.kernel.variance * libm::exp(-s);
                slope[dimensions] += scale * (1.0 + s + s * s / 3.0);
                for (axis, length) in self.kernel.lengths.iter().enumerate() {
                    let apart = (a[axis] - b[axis]) / length;
                    slope[axis] += scale * 5.0 / 3.0 * (1.0 + s) * apart * apart;
                }
            }
        }
        slope
    }

    fn logarithms(&self) -> DVector<f64> {
        let kernel = &self.kernel;
        let rest = [kernel.variance, kernel.noise];
        let all = kernel.lengths.iter().chain(&rest).copied();
        DVector::from_iterator(kernel.lengths.len() + 2, all.map(libm::log))
    }

    /// Follows the likelihood uphill within the bounds: BFGS on the axes that no bound holds (Bertsekas 1982).
    fn ascend(self, values: &[f64]) -> Self {
        let dimensions = self.kernel.lengths.len();
        let bound = |index: usize| {
            let (low, high) = match index.checked_sub(dimensions) {
                None => LENGTH,
                Some(0) => VARIANCE,
                Some(_) => NOISE,
            };
            (libm::log(low), libm::log(high))
        };
        let size = dimensions + 2;
        let mut here = self;
        let mut at = here.logarithms();
        let mut slope = here.slope();
        let mut curvature = DMatrix::<f64>::identity(size, size);
        for _ in 0..STEPS {
            let held: Vec<bool> = (0..size)
                .map(|index| {
                    let (low, high) = bound(index);
                    (at[index] <= low && slope[index] < 0.0)
                        || (at[index] >= high && slope[index] > 0.0)
                })
                .collect();
            let free =
                |v: &DVector<f64>| DVector::from_fn(size, |i, _| if held[i] { 0.0 } else { v[i] });
            let uphill = free(&slope);
            if uphill.amax() < LEVEL {
                break;
            }
            let mut direction = free(&(&curvature * &uphill));
            if direction.dot(&uphill) <= 0.0 {
                curvature.fill_with_identity();
                direction = uphill.clone();
            }
            // No step multiplies a number by more than e².
            direction *= (2.0 / direction.amax()).min(1.0);
            let mut share = 1.0;
            let step = loop {
                let to = DVector::from_fn(size, |index, _| {
                    let (low, high) = bound(index);
                    (at[index] + share * direction[index]).clamp(low, high)
                });
                let kernel = Kernel::from_logarithms(to.as_slice());
                let gain = 1e-4 * uphill.dot(&(&to - &at));
                match Self::new(here.points, values, kernel) {
                    Some(next) if next.log_likelihood >= here.log_likelihood + gain => {
                        break Some((to, next));
                    }
                    _ if share < 1e-3 => break None,
                    _ => share *= 0.4,
                }
            };
            let Some((to, next)) = step else { break };
            let next_slope = next.slope();
            let (moved, bent) = (&to - &at, &slope - &next_slope);
            let product = moved.dot(&bent);
            if product > 1e-10 * moved.norm() * bent.norm() {
                let left = DMatrix::identity(size, size) - &moved * bent.transpose() / product;
                curvature =
                    &left * &curvature * left.transpose() + &moved * moved.transpose() / product;
            }
            (here, at, slope) = (next, to, next_slope);
        }
        here
    }
}

/// Logarithm of the mean amount by which a normal number falls below `best` (Jones, Schonlau & Welch 1998); the logarithm
/// still tells candidates apart where the amount itself is too small for a number (Ament et al. 2023).
pub(super) fn log_expected_improvement(mean: f64, sd: f64, best: f64) -> f64 {
    if sd <= 0.0 {
        return libm::log((best - mean).max(0.0));
    }
    let z = (best - mean) / sd;
    let log_density = -0.5 * z * z - 0.5 * libm::log(2.0 * PI);
    libm::log(sd)
        + if z > -20.0 {
            libm::log(libm::exp(log_density) + 0.5 * z * libm::erfc(-z / SQRT_2))
        } else {
            let w = 1.0 / (z * z);
            log_density + libm::log(w * (1.0 - w * (3.0 - w * (15.0 - w * 105.0))))
        }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Deserialize)]
    struct Query {
        point: Vec<f64>,
        mean: f64,
        sd: f64,
        best: f64,
        log_improvement: f64,
    }

    #[derive(Deserialize)]
    struct Case {
        points: Vec<Vec<f64>>,
        values: Vec<f64>,
        lengths: Vec<f64>,
        variance: f64,
        noise: f64,
        log_likelihood: f64,
        slope: Vec<f64>,
        queries: Vec<Query>,
        best_log_likelihood: f64,
    }

    impl Case {
        fn process(&self) -> GaussianProcess<'_> {
            let kernel = Kernel {
                lengths: self.lengths.clone(),
                variance: self.variance,
                noise: self.noise,
            };
            GaussianProcess::new(&self.points, &self.values, kernel).unwrap()
        }
    }

    /// From scikit-learn: tools/golden_gaussian_process.py.
    fn cases() -> Vec<Case> {
        serde_json::from_str(include_str!("../../tests/golden/gaussian_process.json")).unwrap()
    }

    #[track_caller]
    fn agree(a: f64, b: f64, scale: f64) {
        assert!((a - b).abs() < 1e-6 * scale.max(b.abs()), "{a} is not {b}");
    }

    #[test]
    fn mean_spread_likelihood_and_its_slope_are_those_of_scikit_learn() {
        for case in cases() {
            let process = case.process();
            agree(process.log_likelihood, case.log_likelihood, 1.0);
            for (slope, reference) in process.slope().iter().zip(&case.slope) {
                agree(*slope, *reference, 1.0);
            }
            for query in &case.queries {
                let (mean, sd) = process.predict(&query.point);
                agree(mean, query.mean, 1.0);
                agree(sd, query.sd, 1e-3);
            }
        }
    }

    #[test]
    fn expected_improvement_is_that_of_high_precision_arithmetic_even_where_it_is_no_number() {
        for query in cases().iter().flat_map(|case| &case.queries) {
            let found = log_expected_improvement(query.mean, query.sd, query.best);
            assert!(
                (found - query.log_improvement).abs() < 1e-9 * query.log_improvement.abs(),
                "{found} is not {}",
                query.log_improvement
            );
        }
        assert_eq!(log_expected_improvement(1.0, 0.0, 2.0), 0.0);
        assert_eq!(log_expected_improvement(2.0, 0.0, 1.0), f64::NEG_INFINITY);
    }

    #[test]
    fn the_fitted_kernel_is_as_likely_as_the_best_of_forty_restarts_of_scikit_learn() {
        for case in cases() {
            let fitted = GaussianProcess::fit(&case.points, &case.values).unwrap();
            assert!(
                fitted.log_likelihood > case.best_log_likelihood - 1e-3,
                "{} instead of {}: {:?}",
                fitted.log_likelihood,
                case.best_log_likelihood,
                fitted.kernel()
            );
        }
    }

    #[test]
    fn a_point_seen_twice_is_more_certain_than_seen_once_but_not_quite() {
        let kernel = Kernel {
            lengths: vec![0.5],
            variance: 1.0,
            noise: 0.1,
        };
        let once = [vec![0.5]];
        let twice = [vec![0.5], vec![0.5]];
        let sd = |points: &[Vec<f64>], values: &[f64]| {
            let process = GaussianProcess::new(points, values, kernel.clone()).unwrap();
            process.predict(&[0.5]).1
        };
        // Variance of a normal number with prior variance 1, seen n times with noise 0.1.
        agree(
            sd(&once, &[1.0]),
            (1.0 / (1.0 + 1.0 / 0.1_f64)).sqrt(),
            1e-3,
        );
        agree(
            sd(&twice, &[1.0, 1.1]),
            (1.0 / (1.0 + 2.0 / 0.1_f64)).sqrt(),
            1e-3,
        );
    }

    #[test]
    fn equal_values_can_be_fitted() {
        let points: Vec<Vec<f64>> = (0..6).map(|i| vec![f64::from(i % 3) / 3.0]).collect();
        let fitted = GaussianProcess::fit(&points, &[0.0; 6]).unwrap();
        let (mean, sd) = fitted.predict(&[0.4]);
        assert!(mean == 0.0 && sd.is_finite(), "{mean} {sd}");
    }
}
