//! How much single runs scatter in each part of the search space.
//!
//! Where a motion is chaotic, runs scatter widely about the smooth score; elsewhere, often where the score is low, they hardly scatter.
//! A noise that is the same everywhere would make the quiet part look uncertain, too. So the variance of a run is that of its kernel
//! times a factor, which is found from the residuals of its neighbours (Kersting et al. 2007, with a local mean in place of a second
//! process).

use nalgebra::{DMatrix, DVector};

use crate::kernel::RunKernel;
use crate::scored_run::ScoredRun;

/// Neighbours whose residuals are averaged, and residuals of the expected size that are added to them.
const NEIGHBOURS: usize = 16;
const ADDED: f64 = 0.5;
/// How often factors are found, each time from the residuals of a process with the factors before.
const ROUNDS: usize = 2;

/// One run with the square of its residual, in variances that a process without factors expects.
#[derive(Debug, Clone)]
struct Residual {
    point: Vec<f64>,
    variant: f64,
    square: f64,
}

/// The factor of a run's variance, for every point of the search space.
#[derive(Debug, Clone, Default)]
pub(crate) struct NoiseField {
    residuals: Vec<Residual>,
    /// Length scales of the distance between neighbours.
    lengths: Vec<f64>,
}

impl NoiseField {
    /// From the residuals of runs, each predicted by all others with this kernel.
    pub fn new(kernel: &RunKernel, runs: &[&ScoredRun], values: &DVector<f64>) -> Self {
        let mut field = Self::default();
        for _ in 0..ROUNDS {
            let Some(process) = kernel.condition(runs, values, &field) else {
                break;
            };
            let count = runs.len();
            let inverse = process.solve(&DMatrix::identity(count, count));
            let residual = |index: usize| {
                let run = runs[index];
                // Leave-one-out residual and its variance (Rasmussen & Williams 2006, section 5.4.2).
                let square = process.weights()[index].powi(2) / inverse[(index, index)];
                Residual {
                    point: run.point.clone(),
                    variant: run.variant,
                    square: square * field.factor(&run.point, run.variant),
                }
            };
            field = Self {
                residuals: (0..count).map(residual).collect(),
                // Also along a parameter that does not change the score, runs may scatter differently.
                lengths: kernel.score.lengths.iter().map(|l| l.min(1.0)).collect(),
            };
        }
        field
    }

    /// The factor at a point in a variant.
    pub fn factor(&self, point: &[f64], variant: f64) -> f64 {
        let same = self.residuals.iter().filter(|run| run.variant == variant);
        let mut near: Vec<(f64, f64)> = same
            .map(|run| {
                let axes = run.point.iter().zip(point).zip(&self.lengths);
                let squares = axes.map(|((a, b), length)| ((a - b) / length).powi(2));
                (squares.sum(), run.square)
            })
            .collect();
        if near.len() > NEIGHBOURS {
            near.select_nth_unstable_by(NEIGHBOURS - 1, |a, b| {
                a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
            });
            near.truncate(NEIGHBOURS);
        }
        // Sorted, so that the sum has the same bits whatever the selection did.
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let sum: f64 = near.iter().map(|(_, square)| square).sum();
        (ADDED + sum) / (ADDED + near.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use realgap_core::random::Generator;

    #[test]
    fn a_quiet_part_beside_a_loud_one_is_seen_as_quiet() {
        let mut rng = Generator::seed_from_u64(1);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let runs: Vec<ScoredRun> = (0..120)
            .map(|number| {
                let at = f64::from(number) / 119.0;
                let size = if at < 0.5 { 0.02 } else { 0.4 };
                ScoredRun {
                    point: vec![at],
                    setting: number as u64,
                    variant: 0.0,
                    scores: vec![at + size * normal()],
                    surrogate_scores: Vec::new(),
                }
            })
            .collect();
        let runs: Vec<&ScoredRun> = runs.iter().collect();
        let values = DVector::from_iterator(runs.len(), runs.iter().map(|run| run.score()));
        let kernel = RunKernel::new(&[0.5; 4], &[true]);
        let field = NoiseField::new(&kernel, &runs, &values);
        let (quiet, loud) = (field.factor(&[0.2], 0.0), field.factor(&[0.8], 0.0));
        assert!(loud > 20.0 * quiet, "{quiet} {loud}");
        assert_eq!(NoiseField::default().factor(&[0.2], 0.0), 1.0);
    }
}
