//! How alike the scores of two runs are, and which parameters they depend on.
//!
//! Matérn 5/2 with a length scale a parameter; the sizes are drawn as likely as the scores make them (Metropolis et al. 1953, with
//! weak priors). A parameter that the scores do not depend on has no length.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use realgap_core::error::Result;
use realgap_core::random::Once;
use realgap_core::statistics::{matern_5_2, mean};
use realgap_optimization::{OptimizationProblem, default_optimizer, minimise};

/// One run at one point.
#[derive(Debug, Clone)]
pub struct ScoredRun {
    /// Coordinates of the point, 0 to 1.
    pub at: Vec<f64>,
    /// Number of the setting that it had.
    pub setting: u64,
    /// Which engine it ran in: 1 or -1 where there are two, or else 0.
    pub engine: f64,
    /// One score a fitted recording.
    pub recordings: Vec<f64>,
    /// Where a single recording is fitted, scores against runs of the best point in its place: other recordings that might have
    /// been, each with a setting of its own, some of each engine. Empty where nothing says what they would be.
    pub surrogate_recordings: Vec<Vec<f64>>,
}

impl ScoredRun {
    /// Mean over the recordings.
    pub fn score(&self) -> f64 {
        mean(&self.recordings)
    }
}

/// Sizes of the parts.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// Over how much of an axis scores stay alike, in shares of its range.
    pub lengths: Vec<f64>,
    /// Variance of the score over the parameters.
    pub variance: f64,
    /// Variance of what a setting changes, as a share of it.
    pub between_settings: f64,
    /// Variance of what an engine deviates from the mean of two, as a share of the first; 0 where there is one engine only.
    pub between_engines: f64,
    /// Variance of a single run about that.
    pub noise: f64,
}

/// Bounds of lengths (shares of the range), variance, share between settings, and noise; scores are standardised.
const LENGTH: (f64, f64) = (0.05, 5.0);
const VARIANCE: (f64, f64) = (0.1, 30.0);
const BETWEEN: (f64, f64) = (1e-6, 1.0);
const NOISE: (f64, f64) = (1e-6, 1.0);
/// The same of engines, which may part more than all values of the parameters do.
const ENGINES: (f64, f64) = (1e-6, 10.0);
/// What sizes are likely before any run is seen, as median and standard deviation of the logarithm: wide enough that fifty runs
/// overrule them, narrow enough that ten do not invent a score that changes from point to point.
const LIKELY_LENGTH: (f64, f64) = (0.4, 0.8);
const LIKELY_VARIANCE: (f64, f64) = (1.5, 1.0);
const LIKELY_BETWEEN: (f64, f64) = (0.05, 1.5);
const LIKELY_NOISE: (f64, f64) = (0.03, 1.5);
const LIKELY_ENGINES: (f64, f64) = (0.05, 1.5);
/// Sizes beside the lengths and that of engines.
const SIZES: usize = 3;
/// Kernels tried per number of a kernel to find the likeliest, kernels drawn, and steps of the chain from one to the next.
const TRIES: usize = 40;
const KERNELS: usize = 5;
const STEPS: usize = 5;
/// First and last step of a descent, as shares of what sizes may be, and what a round of it has to gain to be worth another.
const FIRST_STEP: f64 = 0.05;
const LAST_STEP: f64 = 0.01;
const ENOUGH: f64 = 0.1;
/// A parameter acts where the scores are less likely without it by more than this, as deviance: p < 0.01, half of χ² with one
/// degree of freedom, because no action is at the edge of what may be (Self & Liang 1987).
const TELLS: f64 = 5.41;

impl Kernel {
    /// What is not active has no length: scores do not change along it.
    fn new(coordinates: &[f64], active: &[bool]) -> Self {
        let within = |coordinate: f64, (low, high): (f64, f64)| {
            libm::exp(libm::log(low) + coordinate * (libm::log(high) - libm::log(low)))
        };
        let n = active.len();
        let engines = coordinates.get(n + SIZES);
        Self {
            lengths: coordinates[..n]
                .iter()
                .zip(active)
                .map(|(c, active)| match active {
                    true => within(*c, LENGTH),
                    false => f64::INFINITY,
                })
                .collect(),
            variance: within(coordinates[n], VARIANCE),
            between_settings: within(coordinates[n + 1], BETWEEN),
            noise: within(coordinates[n + 2], NOISE),
            between_engines: engines.map_or(0.0, |engines| within(*engines, ENGINES)),
        }
    }

    /// Covariance of the answer at two points.
    pub fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let axes = a.iter().zip(b).zip(&self.lengths);
        let squares = axes.map(|((a, b), length)| ((a - b) / length).powi(2));
        self.variance * matern_5_2(squares.sum::<f64>().sqrt())
    }

    /// Covariance of all runs, factored; `None` where it is singular.
    pub fn factor(&self, runs: &[&ScoredRun]) -> Option<Cholesky<f64, Dyn>> {
        let n = runs.len();
        let mut matrix = DMatrix::zeros(n, n);
        for column in 0..n {
            for row in column..n {
                let (a, b) = (runs[row], runs[column]);
                let same = f64::from(u8::from(a.setting == b.setting));
                let engines = self.between_engines * a.engine * b.engine;
                let alike = 1.0 + self.between_settings * same + engines;
                matrix[(row, column)] = alike * self.covariance(&a.at, &b.at);
            }
            matrix[(column, column)] += self.noise;
        }
        Cholesky::new(matrix)
    }

    /// Minus twice the logarithm of how likely these sizes were before, without its constant.
    fn neg_log_prior(&self) -> f64 {
        let of = |value: f64, (median, sd): (f64, f64)| (libm::log(value / median) / sd).powi(2);
        let lengths = self.lengths.iter().filter(|length| length.is_finite());
        let lengths = lengths.map(|length| of(*length, LIKELY_LENGTH));
        lengths.sum::<f64>()
            + of(self.variance, LIKELY_VARIANCE)
            + of(self.between_settings, LIKELY_BETWEEN)
            + of(self.noise, LIKELY_NOISE)
            + match self.between_engines {
                0.0 => 0.0,
                engines => of(engines, LIKELY_ENGINES),
            }
    }

    /// Minus twice the log likelihood of the values, without its constant; their mean is the likeliest.
    fn neg_log_posterior(&self, runs: &[&ScoredRun], values: &DVector<f64>) -> Option<f64> {
        let factor = self.factor(runs)?;
        let logs: f64 = factor.l_dirty().diagonal().map(libm::log).sum();
        let mean = mean_weights(&factor).dot(values);
        let rest = values.add_scalar(-mean);
        Some(rest.dot(&factor.solve(&rest)) + 2.0 * logs + self.neg_log_prior())
    }
}

/// The coordinates of a kernel that are likeliest for some values, and how little they are so.
#[derive(Debug, Clone)]
struct Likeliest {
    active: Vec<bool>,
    at: Vec<f64>,
    neg_log_posterior: f64,
}

/// Runs and their standardised scores, which kernels are fitted to.
pub(super) struct Fitted<'a> {
    pub runs: Vec<&'a ScoredRun>,
    pub values: DVector<f64>,
}

impl Fitted<'_> {
    fn neg_log_posterior(&self, at: &[f64], active: &[bool]) -> Option<f64> {
        Kernel::new(at, active).neg_log_posterior(&self.runs, &self.values)
    }

    /// Numbers of a kernel.
    fn sizes(&self) -> usize {
        let are_two = self.runs.iter().any(|run| run.engine != 0.0);
        self.runs[0].at.len() + SIZES + usize::from(are_two)
    }

    /// With all parameters: by the optimizer that tunes simulations.
    fn likeliest(&self) -> Result<Option<Likeliest>> {
        let (sizes, active) = (self.sizes(), vec![true; self.runs[0].at.len()]);
        let brief = OptimizationProblem {
            points: vec![2; sizes],
            budget: TRIES * sizes,
            seed: 1,
            priors: Vec::new(),
        };
        let told = minimise(default_optimizer(), &brief, |at| {
            self.neg_log_posterior(at, &active)
        })?;
        let scored = told.into_iter().filter_map(|t| Some((t.score?, t.point)));
        let likeliest = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(likeliest.map(|(neg_log_posterior, at)| {
            self.descended(Likeliest {
                active,
                at,
                neg_log_posterior,
            })
        }))
    }

    /// Down from there along one coordinate after the other, in steps that are halved (Hooke & Jeeves 1961).
    fn descended(&self, from: Likeliest) -> Likeliest {
        let mut here = from;
        let mut step = FIRST_STEP;
        while step > LAST_STEP {
            let before = here.neg_log_posterior;
            for axis in 0..here.at.len() {
                for to in [here.at[axis] - step, here.at[axis] + step] {
                    let mut at = here.at.clone();
                    at[axis] = to.clamp(0.0, 1.0);
                    let neg_log_posterior = self.neg_log_posterior(&at, &here.active);
                    if let Some(neg_log_posterior) = neg_log_posterior
                        .filter(|neg_log_posterior| *neg_log_posterior < here.neg_log_posterior)
                    {
                        (here.at, here.neg_log_posterior) = (at, neg_log_posterior);
                    }
                }
            }
            if before - here.neg_log_posterior < ENOUGH {
                step *= 0.5;
            }
        }
        here
    }

    /// Without the parameters that explain nothing (active variables: Craig et al. 1997; Vernon, Goldstein & Bower 2010): the one
    /// that the scores miss least is left out as long as the likelihood ratio lets it.
    fn selected(&self, with: Likeliest) -> Likeliest {
        let deviance = |of: &Likeliest| {
            // Of the scores alone.
            of.neg_log_posterior - Kernel::new(&of.at, &of.active).neg_log_prior()
        };
        let mut with = with;
        loop {
            let active = (0..with.active.len()).into_par_iter();
            let without = active.filter(|axis| with.active[*axis]).filter_map(|axis| {
                let (mut active, at) = (with.active.clone(), with.at.clone());
                active[axis] = false;
                let neg_log_posterior = self.neg_log_posterior(&at, &active)?;
                Some(self.descended(Likeliest {
                    active,
                    at,
                    neg_log_posterior,
                }))
            });
            // In order, so that the first of equals is the same on any number of threads.
            let without: Vec<Likeliest> = without.collect();
            let least = without
                .into_iter()
                .min_by(|a, b| deviance(a).total_cmp(&deviance(b)));
            match least.filter(|least| deviance(least) - deviance(&with) < TELLS) {
                Some(least) => with = least,
                None => return with,
            }
        }
    }

    /// Kernels as likely as the values make them: a chain from the likeliest.
    pub fn kernels(&self) -> Result<Vec<Kernel>> {
        let (sizes, dimensions) = (self.sizes(), self.runs[0].at.len());
        let Some(likeliest) = self.likeliest()? else {
            return Ok(vec![Kernel::new(
                &vec![0.5; sizes],
                &vec![true; dimensions],
            )]);
        };
        let Likeliest {
            active,
            mut at,
            neg_log_posterior: mut here,
        } = self.selected(likeliest);
        let mut rng = Once::BestPoint.generator(1);
        // Steps grow where they are taken and shrink where they are not, towards one in three.
        let mut step = 0.1;
        let mut drawn = Vec::new();
        for number in 1..=KERNELS * STEPS * sizes {
            let normal = |rng: &mut _| -> f64 { StandardNormal.sample(rng) };
            let to: Vec<f64> = at.iter().map(|c| c + step * normal(&mut rng)).collect();
            let chance: f64 = rng.random();
            let inside = to.iter().all(|c| (0.0..=1.0).contains(c));
            let there = if inside {
                self.neg_log_posterior(&to, &active)
            } else {
                None
            };
            match there.filter(|there| libm::log(chance) < 0.5 * (here - there)) {
                Some(there) => {
                    (here, at) = (there, to);
                    step *= 1.1;
                }
                None => step *= 0.95,
            }
            if number % (STEPS * sizes) == 0 {
                drawn.push(Kernel::new(&at, &active));
            }
        }
        Ok(drawn)
    }
}

/// Shares that the values have in their likeliest mean (ordinary kriging, Cressie 1993, section 3.2): where runs crowd, each
/// counts little, so that a crowd of good ones does not promise that the rest is as good.
pub(super) fn mean_weights(factor: &Cholesky<f64, Dyn>) -> DVector<f64> {
    let ones = DVector::repeat(factor.l_dirty().nrows(), 1.0);
    let solved = factor.solve(&ones);
    let sum = solved.sum();
    solved / sum
}
