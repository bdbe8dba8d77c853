//! Covariance of the scores of runs, with the prior distribution of its hyperparameters.
//!
//! The score is a smooth function of the parameters with a Matérn 5/2 kernel, which has one length scale per parameter. A parameter
//! that the scores do not depend on has an infinite length scale.

use nalgebra::{Cholesky, DVector, Dyn};

use crate::noise_field::NoiseField;
use crate::scored_run::ScoredRun;
use realgap_optimization::gaussian_process::{ConditionedProcess, Matern, Mean, factorise};

/// Hyperparameters of the covariance of runs. Scores are standardised, so variances have no unit.
#[derive(Debug, Clone)]
pub(crate) struct RunKernel {
    /// Kernel of the score over the parameters; length scales are shares of the parameters' ranges.
    pub score: Matern,
    /// Variance of the change by a setting, as a share of the score's variance.
    pub between_settings: f64,
    /// Variance of the deviation of a variant from the mean of two, as a share of the score's variance; 0 where there is one variant.
    pub between_variants: f64,
    /// Variance of a single run about the sum of these functions, where its factor is 1 ([`NoiseField`]).
    pub noise: f64,
}

/// Bounds of the length scales, the variance, the share between settings and the noise.
const LENGTH: (f64, f64) = (0.05, 5.0);
const VARIANCE: (f64, f64) = (0.1, 30.0);
const BETWEEN: (f64, f64) = (1e-6, 1.0);
const NOISE: (f64, f64) = (1e-6, 1.0);
/// Bounds of the share between variants, which may differ by more than all values of the parameters do.
const VARIANTS: (f64, f64) = (1e-6, 10.0);
/// Log-normal prior distributions: median, and standard deviation of the natural logarithm. They are wide enough to be overruled by
/// fifty runs, and narrow enough that ten runs do not imply a score that changes from point to point.
const LENGTH_PRIOR: (f64, f64) = (0.4, 0.8);
const VARIANCE_PRIOR: (f64, f64) = (1.5, 1.0);
const BETWEEN_PRIOR: (f64, f64) = (0.05, 1.5);
const NOISE_PRIOR: (f64, f64) = (0.03, 1.5);
const VARIANTS_PRIOR: (f64, f64) = (0.05, 1.5);
/// Hyperparameters beside the length scales and the share between variants: variance, share between settings, noise.
pub(crate) const SIZES: usize = 3;

impl RunKernel {
    /// From coordinates of the hyperparameters, each from 0 (lower bound) to 1 (upper bound) on a logarithmic scale: length scales,
    /// variance, share between settings, noise and, where there are two variants, the share between these. A parameter that is not
    /// active gets an infinite length scale.
    pub fn new(coordinates: &[f64], active: &[bool]) -> Self {
        let within = |coordinate: f64, (low, high): (f64, f64)| {
            libm::exp(libm::log(low) + coordinate * (libm::log(high) - libm::log(low)))
        };
        let n = active.len();
        let variants = coordinates.get(n + SIZES);
        Self {
            score: Matern {
                lengths: coordinates[..n]
                    .iter()
                    .zip(active)
                    .map(|(c, active)| match active {
                        true => within(*c, LENGTH),
                        false => f64::INFINITY,
                    })
                    .collect(),
                variance: within(coordinates[n], VARIANCE),
            },
            between_settings: within(coordinates[n + 1], BETWEEN),
            noise: within(coordinates[n + 2], NOISE),
            between_variants: variants.map_or(0.0, |variants| within(*variants, VARIANTS)),
        }
    }

    /// Factorised covariance of all runs, whose noise has these factors; `None` where it is singular.
    fn factor(&self, runs: &[&ScoredRun], factors: &[f64]) -> Option<Cholesky<f64, Dyn>> {
        let covariance = |row: usize, column: usize| {
            let (a, b) = (runs[row], runs[column]);
            let noise = match row == column {
                true => self.noise * factors[row],
                false => 0.0,
            };
            let same = f64::from(u8::from(a.setting == b.setting));
            let variants = self.between_variants * a.variant * b.variant;
            let shared = 1.0 + self.between_settings * same + variants;
            shared * self.score.covariance(&a.point, &b.point) + noise
        };
        factorise(runs.len(), covariance, 0.0)
    }

    /// The process with this kernel and an unknown mean, conditioned on the runs' values; `None` where the covariance is singular.
    pub fn condition(
        &self,
        runs: &[&ScoredRun],
        values: &DVector<f64>,
        noise: &NoiseField,
    ) -> Option<ConditionedProcess> {
        let factors = runs.iter().map(|run| noise.factor(&run.point, run.variant));
        self.with_factors(runs, values, &factors.collect::<Vec<_>>())
    }

    /// The same with the factors of the runs' noise.
    fn with_factors(
        &self,
        runs: &[&ScoredRun],
        values: &DVector<f64>,
        factors: &[f64],
    ) -> Option<ConditionedProcess> {
        let factor = self.factor(runs, factors)?;
        Some(ConditionedProcess::new(factor, values, Mean::Estimated))
    }

    /// Minus twice the logarithm of the prior density of these hyperparameters, without its constant.
    pub(crate) fn neg_log_prior(&self) -> f64 {
        let of = |value: f64, (median, sd): (f64, f64)| (libm::log(value / median) / sd).powi(2);
        let lengths = self.score.lengths.iter();
        let lengths = lengths.filter(|length| length.is_finite());
        let lengths = lengths.map(|length| of(*length, LENGTH_PRIOR));
        lengths.sum::<f64>()
            + of(self.score.variance, VARIANCE_PRIOR)
            + of(self.between_settings, BETWEEN_PRIOR)
            + of(self.noise, NOISE_PRIOR)
            + match self.between_variants {
                0.0 => 0.0,
                variants => of(variants, VARIANTS_PRIOR),
            }
    }

    /// Minus twice the logarithm of the posterior density of these hyperparameters given the values, without its constant.
    pub(crate) fn neg_log_posterior(
        &self,
        runs: &[&ScoredRun],
        values: &DVector<f64>,
        factors: &[f64],
    ) -> Option<f64> {
        let process = self.with_factors(runs, values, factors)?;
        Some(process.deviance() + self.neg_log_prior())
    }
}
