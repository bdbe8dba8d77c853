//! Points that fill space evenly without being a grid.

use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// Low-discrepancy search; also the first design of the others.
pub(super) struct Random;

/// Points in one batch; the sequence is the same for any.
const BATCH: usize = 64;

/// Length of one Sobol sequence as the library tabulates it; after that another scrambling begins.
const SEQUENCE: usize = 1 << 16;

/// Points `from..to` of the Owen-scrambled Sobol sequence of this seed (Burley 2020).
pub fn space_filling(dimensions: usize, from: usize, to: usize, seed: u64) -> Vec<UnitPoint> {
    (from..to)
        .map(|index| {
            (0..dimensions)
                .map(|dimension| {
                    // More dimensions than are tabulated are taken from further scramblings.
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
        "A scrambled Sobol sequence (Burley 2020): even cover of any number of parameters, the yardstick for the others."
    }

    fn design(&self, _dimensions: usize) -> usize {
        0
    }

    fn batch(&self, brief: &OptimizationProblem) -> usize {
        BATCH.min(brief.budget)
    }

    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let from = history.design.len() + history.told.len();
        Ok(Proposal::Evaluate(space_filling(
            brief.dimensions(),
            from,
            from + self.batch(brief),
            brief.seed,
        )))
    }
}
