//! The optimizer `random`, a low-discrepancy (Sobol) sequence, which also gives the initial designs of the other optimizers.

use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// Search by a low-discrepancy sequence.
pub(super) struct Random;

/// Number of points in one batch; the sequence does not depend on it.
const BATCH: usize = 64;

/// Length of one Sobol sequence in the library's table; further points use another scrambling.
const SEQUENCE: usize = 1 << 16;

/// Points `from..to` of the Owen-scrambled Sobol sequence of this seed (Burley 2020).
pub fn space_filling(dimensions: usize, from: usize, to: usize, seed: u64) -> Vec<UnitPoint> {
    (from..to)
        .map(|index| {
            (0..dimensions)
                .map(|dimension| {
                    // Dimensions beyond those in the library's table use further scramblings.
                    let (block, column) = (dimension / 256, dimension % 256);
                    let scrambling = (seed as u32)
                        .wrapping_mul(0x9E37_79B1)
                        .wrapping_add((index / SEQUENCE) as u32)
                        .wrapping_add((block as u32).wrapping_mul(0x85EB_CA6B));
                    f64::from(sobol_burley::sample(
                        (index % SEQUENCE) as u32,
                        column as u32,
                        scrambling,
                    ))
                })
                .collect()
        })
        .collect()
}

impl Optimizer for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    fn doc(&self) -> &'static str {
        "A scrambled Sobol sequence (Burley 2020): even cover of any number of parameters, the baseline for the others."
    }

    fn design(&self, _dimensions: usize) -> usize {
        0
    }

    fn batch(&self, problem: &OptimizationProblem) -> usize {
        BATCH.min(problem.budget)
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let from = history.design.len() + history.evaluated.len();
        Ok(Proposal::Evaluate(space_filling(
            problem.dimensions(),
            from,
            from + self.batch(problem),
            problem.seed,
        )))
    }
}
