//! Kernels that explain the scores of some runs: the one of highest posterior density, the parameters that it needs, and draws from
//! the posterior distribution of kernels.

use nalgebra::DVector;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use crate::kernel::{RunKernel, SIZES};
use crate::noise_field::NoiseField;
use crate::scored_run::ScoredRun;
use realgap_core::error::Result;
use realgap_core::random::Once;
use realgap_optimization::{OptimizationProblem, default_optimizer, minimise};

/// Kernels that the optimizer tries per hyperparameter to find the one of highest posterior density.
const TRIES: usize = 40;
/// Kernels that are drawn, and steps of the Markov chain per hyperparameter from one draw to the next.
const KERNELS: usize = 5;
const STEPS: usize = 5;
/// First and last step of a descent, as shares of the hyperparameters' ranges (on a logarithmic scale), and how far a round of the
/// descent has to lower the negative log posterior to be followed by another with the same step.
const FIRST_STEP: f64 = 0.05;
const LAST_STEP: f64 = 0.01;
const ENOUGH: f64 = 0.1;
/// A parameter is active where the deviance of the scores rises by more than this without it. This is p < 0.01 of half of a
/// chi-squared distribution with one degree of freedom, because "no effect" is at the boundary of the hyperparameters (Self & Liang
/// 1987).
const ACTIVE_DEVIANCE: f64 = 5.41;

/// Kernel of maximum posterior density among those with the same active parameters.
#[derive(Debug, Clone)]
struct MaximumAPosteriori {
    /// Which parameters have a finite length scale.
    active: Vec<bool>,
    /// Coordinates of the hyperparameters, as [`RunKernel::new`] takes them.
    at: Vec<f64>,
    /// Minus twice the logarithm of the posterior density there, without its constant.
    neg_log_posterior: f64,
}

/// Runs and their standardised scores, to which kernels are fitted.
pub(crate) struct KernelData<'a> {
    pub runs: Vec<&'a ScoredRun>,
    pub values: DVector<f64>,
    /// Factors of the runs' noise.
    factors: Vec<f64>,
}

impl<'a> KernelData<'a> {
    pub fn new(runs: Vec<&'a ScoredRun>, values: DVector<f64>) -> Self {
        let factors = vec![1.0; runs.len()];
        Self {
            runs,
            values,
            factors,
        }
    }

    fn neg_log_posterior(&self, at: &[f64], active: &[bool]) -> Option<f64> {
        RunKernel::new(at, active).neg_log_posterior(&self.runs, &self.values, &self.factors)
    }

    /// Number of hyperparameters of a kernel.
    fn hyperparameters(&self) -> usize {
        let has_two_variants = self.runs.iter().any(|run| run.variant != 0.0);
        self.runs[0].point.len() + SIZES + usize::from(has_two_variants)
    }

    /// The kernel of maximum posterior density with all parameters active, found by the default optimizer and a descent.
    fn maximum_a_posteriori(&self) -> Result<Option<MaximumAPosteriori>> {
        let (count, active) = (self.hyperparameters(), vec![true; self.runs[0].point.len()]);
        let problem = OptimizationProblem {
            points: vec![2; count],
            budget: TRIES * count,
            seed: 1,
            priors: Vec::new(),
            error_blocks: Vec::new(),
            own: None,
        };
        let evaluated = minimise(default_optimizer(), &problem, |at| {
            self.neg_log_posterior(at, &active)
        })?;
        let scored = evaluated
            .into_iter()
            .filter_map(|t| Some((t.score?, t.point)));
        let lowest = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(lowest.map(|(neg_log_posterior, at)| {
            self.descended(MaximumAPosteriori {
                active,
                at,
                neg_log_posterior,
            })
        }))
    }

    /// Descends from a kernel along one hyperparameter after the other, with steps that are halved (Hooke & Jeeves 1961).
    fn descended(&self, from: MaximumAPosteriori) -> MaximumAPosteriori {
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

    /// Selects the active parameters (Craig et al. 1997; Vernon, Goldstein & Bower 2010): as long as the likelihood ratio test allows
    /// it, the parameter whose removal raises the deviance least becomes inactive.
    fn selected(&self, with: MaximumAPosteriori) -> MaximumAPosteriori {
        let deviance = |of: &MaximumAPosteriori| {
            // The deviance of the scores alone, without the prior.
            of.neg_log_posterior - RunKernel::new(&of.at, &of.active).neg_log_prior()
        };
        let mut with = with;
        loop {
            let active = (0..with.active.len()).into_par_iter();
            let without = active.filter(|axis| with.active[*axis]).filter_map(|axis| {
                let (mut active, at) = (with.active.clone(), with.at.clone());
                active[axis] = false;
                let neg_log_posterior = self.neg_log_posterior(&at, &active)?;
                Some(self.descended(MaximumAPosteriori {
                    active,
                    at,
                    neg_log_posterior,
                }))
            });
            // The order is that of the parameters, so that the first of equals is the same on any number of threads.
            let without: Vec<MaximumAPosteriori> = without.collect();
            let least = without
                .into_iter()
                .min_by(|a, b| deviance(a).total_cmp(&deviance(b)));
            match least.filter(|least| deviance(least) - deviance(&with) < ACTIVE_DEVIANCE) {
                Some(least) => with = least,
                None => return with,
            }
        }
    }

    /// Draws from the posterior distribution of kernels, a random-walk Metropolis chain from the kernel of maximum posterior density
    /// (Metropolis et al. 1953); and the factors of the noise.
    pub fn kernels(mut self) -> Result<(Vec<RunKernel>, NoiseField)> {
        let (count, dimensions) = (self.hyperparameters(), self.runs[0].point.len());
        let Some(maximum) = self.maximum_a_posteriori()? else {
            let kernel = RunKernel::new(&vec![0.5; count], &vec![true; dimensions]);
            return Ok((vec![kernel], NoiseField::default()));
        };
        let noise = NoiseField::new(
            &RunKernel::new(&maximum.at, &maximum.active),
            &self.runs,
            &self.values,
        );
        let factors = self.runs.iter();
        let factors = factors.map(|run| noise.factor(&run.point, run.variant));
        self.factors = factors.collect();
        // The kernel belongs to these factors.
        let maximum = match self.neg_log_posterior(&maximum.at, &maximum.active) {
            Some(neg_log_posterior) => self.descended(MaximumAPosteriori {
                neg_log_posterior,
                ..maximum
            }),
            None => maximum,
        };
        let MaximumAPosteriori {
            active,
            mut at,
            neg_log_posterior: mut here,
        } = self.selected(maximum);
        let mut rng = Once::BestPoint.generator(1);
        // An accepted step makes the next ones larger, a rejected step makes them smaller: about one in three is accepted.
        let mut step = 0.1;
        let mut drawn = Vec::new();
        for number in 1..=KERNELS * STEPS * count {
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
            if number % (STEPS * count) == 0 {
                drawn.push(RunKernel::new(&at, &active));
            }
        }
        Ok((drawn, noise))
    }
}
