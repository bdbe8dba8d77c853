//! A Gaussian process with zero mean, a Matérn 5/2 kernel and noise over points of the search space, with the slope of its
//! likelihood (Rasmussen & Williams 2006, equations 4.17, 5.8 and 5.9).

use std::f64::consts::PI;

use nalgebra::DVector;

use super::{ConditionedProcess, Matern, Mean, factorise};

/// The numbers that a process has beside its points and values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hyperparameters {
    /// The kernel of the function.
    pub kernel: Matern,
    /// Variance of a value about the function.
    pub noise: f64,
}

impl Hyperparameters {
    /// From the logarithms of length scales, variance and noise.
    pub(super) fn from_logarithms(logarithms: &[f64]) -> Self {
        let n = logarithms.len() - 2;
        let value = |index: usize| libm::exp(logarithms[index]);
        Self {
            kernel: Matern {
                lengths: (0..n).map(value).collect(),
                variance: value(n),
            },
            noise: value(n + 1),
        }
    }

    /// Logarithms of length scales, variance and noise.
    pub(super) fn logarithms(&self) -> DVector<f64> {
        let lengths = &self.kernel.lengths;
        let rest = [self.kernel.variance, self.noise];
        let all = lengths.iter().chain(&rest).copied();
        DVector::from_iterator(lengths.len() + 2, all.map(libm::log))
    }
}

/// What is known about a function from noisy values of it.
pub(crate) struct GaussianProcess<'a> {
    pub(super) points: &'a [Vec<f64>],
    hyperparameters: Hyperparameters,
    process: ConditionedProcess,
    /// Logarithm of the probability density of the values.
    pub(super) log_likelihood: f64,
}

impl<'a> GaussianProcess<'a> {
    /// With known hyperparameters; far from all points the expected value is zero. `None` where the covariance is singular.
    pub fn new(
        points: &'a [Vec<f64>],
        values: &[f64],
        hyperparameters: Hyperparameters,
    ) -> Option<Self> {
        let n = points.len();
        let kernel = &hyperparameters.kernel;
        let covariance =
            |row: usize, column: usize| kernel.covariance(&points[row], &points[column]);
        let factor = factorise(n, covariance, hyperparameters.noise)?;
        let values = DVector::from_column_slice(values);
        let process = ConditionedProcess::new(factor, &values, Mean::Zero);
        Some(Self {
            points,
            log_likelihood: -0.5 * process.deviance() - 0.5 * n as f64 * libm::log(2.0 * PI),
            hyperparameters,
            process,
        })
    }

    /// Kernel and noise.
    pub fn hyperparameters(&self) -> &Hyperparameters {
        &self.hyperparameters
    }

    /// Mean and standard deviation of the function (not of a value of it, which has noise).
    pub fn predict(&self, point: &[f64]) -> (f64, f64) {
        let kernel = &self.hyperparameters.kernel;
        let known = self.points.iter();
        let covariances = DVector::from_iterator(
            self.points.len(),
            known.map(|known| kernel.covariance(point, known)),
        );
        let mean = self.process.mean(&covariances);
        (mean, self.process.deviation(covariances, kernel.variance))
    }

    /// Slope of the log likelihood along the logarithms of lengths, variance and noise.
    pub(super) fn slope(&self) -> DVector<f64> {
        let Hyperparameters { kernel, noise } = &self.hyperparameters;
        let (n, dimensions) = (self.points.len(), kernel.lengths.len());
        // ½ tr((α αᵀ − K⁻¹) ∂K), of which only the symmetric half is summed.
        let inverse = self.process.inverse_covariance();
        let weights = self.process.weights();
        let mut slope = DVector::zeros(dimensions + 2);
        for column in 0..n {
            let on_diagonal = weights[column].powi(2) - inverse[(column, column)];
            slope[dimensions] += 0.5 * on_diagonal * kernel.variance;
            slope[dimensions + 1] += 0.5 * on_diagonal * noise;
            for row in column + 1..n {
                let weight = weights[row] * weights[column] - inverse[(row, column)];
                let (a, b) = (&self.points[row], &self.points[column]);
                let s = 5.0_f64.sqrt() * kernel.distance(a, b);
                let scale = weight * kernel.variance * libm::exp(-s);
                slope[dimensions] += scale * (1.0 + s + s * s / 3.0);
                for (axis, length) in kernel.lengths.iter().enumerate() {
                    let difference = (a[axis] - b[axis]) / length;
                    slope[axis] += scale * 5.0 / 3.0 * (1.0 + s) * difference * difference;
                }
            }
        }
        slope
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
            let kernel = Matern {
                lengths: self.lengths.clone(),
                variance: self.variance,
            };
            let hyperparameters = Hyperparameters {
                kernel,
                noise: self.noise,
            };
            GaussianProcess::new(&self.points, &self.values, hyperparameters).unwrap()
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
    fn joint_predictions_have_the_means_and_deviations_of_single_ones() {
        for case in cases() {
            let process = case.process();
            let kernel = &process.hyperparameters.kernel;
            let (points, queries) = (&case.points, &case.queries);
            let across = nalgebra::DMatrix::from_fn(points.len(), queries.len(), |row, column| {
                kernel.covariance(&points[row], &queries[column].point)
            });
            let prior = nalgebra::DMatrix::from_fn(queries.len(), queries.len(), |row, column| {
                kernel.covariance(&queries[row].point, &queries[column].point)
            });
            let joint = process.process.predict(&across, &prior);
            for (index, query) in queries.iter().enumerate() {
                agree(joint.means[index], query.mean, 1.0);
                let variance = joint.covariance[(index, index)];
                assert!((variance - query.sd.powi(2)).abs() < 1e-6, "{variance}");
            }
        }
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
                fitted.hyperparameters()
            );
        }
    }

    #[test]
    fn a_point_seen_twice_is_more_certain_than_seen_once_but_not_quite() {
        let hyperparameters = Hyperparameters {
            kernel: Matern {
                lengths: vec![0.5],
                variance: 1.0,
            },
            noise: 0.1,
        };
        let once = [vec![0.5]];
        let twice = [vec![0.5], vec![0.5]];
        let sd = |points: &[Vec<f64>], values: &[f64]| {
            let process = GaussianProcess::new(points, values, hyperparameters.clone()).unwrap();
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
