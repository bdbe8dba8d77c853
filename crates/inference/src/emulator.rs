//! An emulator: what some runs tell about the score at every point, points without a run included.
//!
//! On a logarithmic scale, the score of a run is the sum of a smooth function of the parameters, a smooth deviation that belongs to
//! the run's setting, and noise of the single run. Where there are two variants of the black box, half of their difference is one
//! more smooth function, which is added for one variant and subtracted for the other; the first function is then the mean of both
//! variants, whichever of them was run where. All but the noise are Gaussian processes with one Matérn 5/2 kernel shape (Rasmussen &
//! Williams 2006; sums of processes: section 4.2.4). Their hyperparameters are not known: several kernels are drawn from their
//! posterior distribution, and the differences between their predictions are part of the uncertainty.

use nalgebra::{DMatrix, DVector};

use crate::kernel::RunKernel;
use crate::kernel_fit::KernelData;
use crate::noise_field::NoiseField;
use crate::run_selection::{better_half, spread};
use crate::scale::ScoreScale;
use crate::scored_run::ScoredRun;
use realgap_core::error::Result;
use realgap_core::statistics::mean;
use realgap_optimization::gaussian_process::ConditionedProcess;

/// Most runs that kernels are fitted to, and most runs that the emulator is conditioned on; work grows with the cube of either.
const FITTED: usize = 120;
const KNOWN: usize = 600;
/// Most runs that the emulator of the whole search space knows.
const SPREAD: usize = 60;
/// Fewest runs to which kernels are fitted.
const FEWEST: usize = 3;

/// One kernel, with the process that is conditioned on the runs.
#[derive(Debug, Clone)]
struct Member {
    kernel: RunKernel,
    process: ConditionedProcess,
}

/// The score over the parameters.
#[derive(Debug, Clone)]
pub struct Emulator {
    scale: ScoreScale,
    /// Coordinates of the runs.
    points: Vec<Vec<f64>>,
    /// Variants of the runs, as [`ScoredRun::variant`].
    variants: Vec<f64>,
    /// Deviation of each observation's score (column) from the mean over the observations, standardised; one row a run.
    observation_deviations: DMatrix<f64>,
    members: Vec<Member>,
    /// How much runs scatter in each part of the search space.
    noise: NoiseField,
    /// The emulator of the whole search space, where there are more runs than it needs: of runs that are spread over the space.
    ///
    /// Runs crowd where scores are low. There the scale of the scores and the kernel show details that the kernel then expects
    /// everywhere, and far away, between distant runs, the emulator forgets what these runs told before. So what the runs that are
    /// spread over the space rule out is not believed again (refocusing: Vernon, Goldstein & Bower 2010, section 3).
    overview: Option<Box<Self>>,
}

/// What the emulator predicts for several points jointly. Scores are standardised: mean 0 and standard deviation 1 over the runs.
pub struct ScoreField {
    /// Expected scores.
    pub means: DVector<f64>,
    /// Covariance of the scores that the runs leave.
    pub emulator: DMatrix<f64>,
    /// Variance of the score before any run.
    pub variance: f64,
    /// Covariance of the change by another equally valid setting.
    pub numerics: DMatrix<f64>,
    /// Deviation of each observation's score (column) from the mean over the observations; one row a point.
    pub observation_deviations: DMatrix<f64>,
    /// Correlation of the score between the points, before any run.
    pub correlation: DMatrix<f64>,
    /// Variance of single runs about their setting.
    pub noise: f64,
    /// Variance of settings.
    pub setting: f64,
    /// Variance of observations.
    pub observation: f64,
}

impl Emulator {
    /// Fits kernels to the runs. `None` for fewer than three runs.
    ///
    /// # Errors
    /// None beyond those of the optimizer that finds the kernel of maximum posterior density.
    pub fn new(runs: &[ScoredRun]) -> Result<Option<Self>> {
        if runs.len() < FEWEST {
            return Ok(None);
        }
        let overview = spread(runs, SPREAD);
        let overview = match runs.len() > SPREAD && overview.len() >= FEWEST {
            true => Some(Box::new(Self::fitted(&overview, &overview, &overview)?)),
            false => None,
        };
        let all: Vec<&ScoredRun> = runs.iter().collect();
        let (fitted, known) = (better_half(runs, FITTED), better_half(runs, KNOWN));
        Ok(Some(Self {
            overview,
            ..Self::fitted(&all, &fitted, &known)?
        }))
    }

    /// The scale of the scores of some runs, and kernels that are fitted to others and conditioned on others still.
    fn fitted(scaled: &[&ScoredRun], fitted: &[&ScoredRun], known: &[&ScoredRun]) -> Result<Self> {
        let scores: Vec<f64> = scaled.iter().map(|run| run.score()).collect();
        let scale = ScoreScale::new(&scores);
        let data = KernelData::new(fitted.to_vec(), values(scale, fitted));
        let (kernels, noise) = data.kernels()?;
        Ok(Self::with(scale, &kernels, noise, known))
    }

    /// The same kernels, conditioned on other runs: mostly on the earlier ones and some more.
    #[must_use]
    pub fn conditioned_on(&self, runs: &[ScoredRun]) -> Self {
        let again = |emulator: &Self, known: &[&ScoredRun]| {
            let kernels = emulator.members.iter().map(|m| m.kernel.clone());
            let noise = emulator.noise.clone();
            Self::with(emulator.scale, &kernels.collect::<Vec<_>>(), noise, known)
        };
        let overview = self.overview.as_deref();
        Self {
            overview: overview.map(|overview| Box::new(again(overview, &spread(runs, SPREAD)))),
            ..again(self, &better_half(runs, KNOWN))
        }
    }

    /// The emulator of the whole search space, where there are so many runs that there is one.
    pub(crate) fn overview(&self) -> Option<&Self> {
        self.overview.as_deref()
    }

    fn with(
        scale: ScoreScale,
        kernels: &[RunKernel],
        noise: NoiseField,
        runs: &[&ScoredRun],
    ) -> Self {
        let values = values(scale, runs);
        let observation_deviations = match runs[0].surrogate_scores.as_slice() {
            [] => DMatrix::from_fn(runs.len(), runs[0].scores.len(), |run, observation| {
                let score = runs[run].score();
                scale.slope(score) * (runs[run].scores[observation] - score)
            }),
            variants => {
                let columns = variants.iter().map(Vec::len).sum();
                let rows = runs
                    .iter()
                    .flat_map(|run| surrogate_deviations(scale, &run.surrogate_scores));
                DMatrix::from_row_iterator(runs.len(), columns, rows)
            }
        };
        let members = kernels.iter().filter_map(|kernel| {
            Some(Member {
                kernel: kernel.clone(),
                process: kernel.condition(runs, &values, &noise)?,
            })
        });
        Self {
            scale,
            members: members.collect(),
            points: runs.iter().map(|run| run.point.clone()).collect(),
            variants: runs.iter().map(|run| run.variant).collect(),
            observation_deviations,
            noise,
            overview: None,
        }
    }

    /// Covariance of a run with the score at a point: in a variant, or, for 0, on average over both.
    fn covariance(&self, kernel: &RunKernel, run: usize, point: &[f64], variant: f64) -> f64 {
        let shared = 1.0 + kernel.between_variants * variant * self.variants[run];
        shared * kernel.score.covariance(&self.points[run], point)
    }

    /// Expected scores at a point, standardised, in each of these variants; 0 is the average over both.
    pub fn standardised_in(&self, point: &[f64], variants: &[f64]) -> Vec<f64> {
        let share = 1.0 / self.members.len() as f64;
        let mut expected = vec![0.0; variants.len()];
        for member in &self.members {
            let runs = self.points.iter();
            let shared = runs.map(|run| member.kernel.score.covariance(run, point));
            let shared = DVector::from_iterator(self.points.len(), shared);
            for (expected, variant) in expected.iter_mut().zip(variants) {
                let between = member.kernel.between_variants * variant;
                let across = DVector::from_fn(shared.len(), |run, _| {
                    shared[run] * (1.0 + between * self.variants[run])
                });
                *expected += share * member.process.mean(&across);
            }
        }
        expected
    }

    /// Expected score at a point, standardised, on average over the variants.
    pub fn standardised(&self, point: &[f64]) -> f64 {
        self.standardised_in(point, &[0.0])[0]
    }

    /// Expected score at a point in one variant. A number between -1 and 1 is a weighted mean of both on the emulator's scale.
    pub fn mean_in(&self, point: &[f64], variant: f64) -> f64 {
        self.scale.score(self.standardised_in(point, &[variant])[0])
    }

    /// The score from which on all scores count as one: an expected score near it says no more than that the score is high.
    pub fn highest(&self) -> f64 {
        self.scale.highest()
    }

    /// The variants of the runs: 1 and -1 where there are two, 0 where there is one.
    pub fn variants(&self) -> &'static [f64] {
        match self.has_two_variants() {
            true => &[1.0, -1.0],
            false => &[0.0],
        }
    }

    /// Whether the runs are of two variants.
    pub fn has_two_variants(&self) -> bool {
        self.variants.iter().any(|variant| *variant != 0.0)
    }

    /// The same probability for every variant.
    pub fn equal_weights(&self) -> Vec<f64> {
        let variants = self.variants().len();
        vec![1.0 / variants as f64; variants]
    }

    /// Expected score at a point.
    pub fn mean(&self, point: &[f64]) -> f64 {
        self.scale.score(self.standardised(point))
    }

    /// Central range of the score at a point in a variant, `deviations` standard deviations to each side of the expected score.
    pub fn band(&self, point: &[f64], variant: f64, deviations: f64) -> (f64, f64) {
        let field = self.field_in(std::slice::from_ref(&point.to_vec()), variant);
        let half = deviations * field.emulator[(0, 0)].max(0.0).sqrt();
        let at = |side: f64| self.scale.score(field.means[0] + side);
        (at(-half), at(half))
    }

    /// Which parameters the scores depend on, as far as the runs show it.
    pub fn active(&self) -> Vec<bool> {
        let members = self.members.iter();
        let lengths = members.flat_map(|member| &member.kernel.score.lengths);
        let dimensions = self.points[0].len();
        lengths
            .take(dimensions)
            .map(|length| length.is_finite())
            .collect()
    }

    /// Joint prediction for several points in a variant, or, for 0, on average over both.
    pub fn field_in(&self, points: &[Vec<f64>], variant: f64) -> ScoreField {
        let runs = self.points.len();
        let (n, observations) = (points.len(), self.observation_deviations.ncols());
        let square = || DMatrix::zeros(n, n);
        let freedom = (runs * (observations - 1).max(1)) as f64;
        let mut field = ScoreField {
            means: DVector::zeros(n),
            emulator: square(),
            variance: 0.0,
            numerics: square(),
            observation_deviations: DMatrix::zeros(n, observations),
            correlation: square(),
            noise: 0.0,
            setting: 0.0,
            observation: self.observation_deviations.norm_squared() / freedom,
        };
        let share = 1.0 / self.members.len() as f64;
        let mut means = Vec::new();
        for member in &self.members {
            let kernel = &member.kernel;
            let across = DMatrix::from_fn(runs, n, |run, point| {
                self.covariance(kernel, run, &points[point], variant)
            });
            let mut between = square();
            for column in 0..n {
                for row in column..n {
                    let covariance = kernel.score.covariance(&points[row], &points[column]);
                    (between[(row, column)], between[(column, row)]) = (covariance, covariance);
                }
            }
            let own = 1.0 + kernel.between_variants * variant * variant;
            let prior = &between * own;
            let predicted = member.process.predict(&across, &prior);
            field.observation_deviations +=
                predicted.weights * &self.observation_deviations * share;
            field.emulator += predicted.covariance * share;
            field.variance += kernel.score.variance * own * share;
            field.numerics += &between * (kernel.between_settings * share);
            field.correlation += between * (share / kernel.score.variance);
            field.noise += kernel.noise * share;
            field.setting += kernel.between_settings * kernel.score.variance * share;
            field.means += &predicted.means * share;
            means.push(predicted.means);
        }
        for mean in means {
            let deviation = mean - &field.means;
            field.emulator += &deviation * deviation.transpose() * share;
        }
        field
    }
}

/// Standardised scores of runs.
fn values(scale: ScoreScale, runs: &[&ScoredRun]) -> DVector<f64> {
    let values = runs.iter().map(|run| scale.standardise(run.score()));
    DVector::from_iterator(runs.len(), values)
}

/// Standardised deviations of a run's surrogate scores from the mean of their variant, scaled as if all were of one variant whose
/// variance is the mean variance of both: the observation is like an output of one of the variants. Surrogate outputs differ as much
/// from the observation as from each other, so that no slope of the scale holds for all of them and each is transformed by itself.
fn surrogate_deviations(scale: ScoreScale, variants: &[Vec<f64>]) -> Vec<f64> {
    let freedom = |count: usize| count as f64 - 1.0;
    let all = freedom(variants.iter().map(Vec::len).sum());
    let of = |scores: &Vec<f64>| {
        let scores: Vec<f64> = scores
            .iter()
            .map(|score| scale.standardise(*score))
            .collect();
        let middle = mean(&scores);
        let share = (all / (variants.len() as f64 * freedom(scores.len()))).sqrt();
        scores
            .into_iter()
            .map(move |score| share * (score - middle))
    };
    variants.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::statistics::standard_deviation;

    #[test]
    fn surrogates_vary_as_either_variant_does_on_average_however_many_runs_each_has() {
        let scale = ScoreScale::new(&[1.0, 2.0, 4.0]);
        let variants = [vec![1.0, 3.0], vec![2.0, 2.1, 2.2, 2.1, 2.0]];
        let deviations = surrogate_deviations(scale, &variants);
        let squares = deviations.iter().map(|deviation| deviation * deviation);
        let variance = squares.sum::<f64>() / (deviations.len() - 1) as f64;
        let of = |scores: &Vec<f64>| {
            let scores: Vec<f64> = scores
                .iter()
                .map(|score| scale.standardise(*score))
                .collect();
            standard_deviation(&scores).powi(2)
        };
        let expected = 0.5 * (of(&variants[0]) + of(&variants[1]));
        assert!(
            (variance - expected).abs() < 1e-12,
            "{variance}, {expected}"
        );
        // One variant alone deviates as it does.
        let alone = surrogate_deviations(scale, &variants[..1]);
        let difference = alone[1] - alone[0];
        let expected = scale.standardise(3.0) - scale.standardise(1.0);
        assert!((difference - expected).abs() < 1e-12);
    }
}
