//! Every combination of evenly spaced values.

use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// The simplest optimizer: it does not listen.
pub(super) struct FullGrid;

impl FullGrid {
    /// The study's own number of points along each parameter where the budget allows, else as many as fit evenly.
    fn points(brief: &OptimizationProblem) -> Vec<usize> {
        let wanted = brief
            .points
            .iter()
            .try_fold(1_usize, |size, points| size.checked_mul(*points));
        if wanted.is_some_and(|size| size <= brief.budget) {
            return brief.points.clone();
        }
        let dimensions = brief.dimensions() as u32;
        let each = (2..=brief.budget)
            .take_while(|n| {
                n.checked_pow(dimensions)
                    .is_some_and(|size| size <= brief.budget)
            })
            .last()
            .unwrap_or(2);
        vec![each; brief.dimensions()]
    }
}

impl Optimizer for FullGrid {
    fn name(&self) -> &'static str {
        "grid"
    }

    fn doc(&self) -> &'static str {
        "Every combination of evenly spaced values: the study's own points, or as many as the budget allows (paper 003, section 2.3)."
    }

    fn design(&self, _dimensions: usize) -> usize {
        0
    }

    fn batch(&self, brief: &OptimizationProblem) -> usize {
        Self::points(brief).iter().product()
    }

    fn depends_on_budget(&self) -> bool {
        true
    }

    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        if !history.told.is_empty() {
            return Ok(Proposal::Exhausted);
        }
        let points = Self::points(brief);
        let size: usize = points.iter().product();
        let candidates = (0..size).map(|index| {
            let mut rest = index;
            let mut point: UnitPoint = points
                .iter()
                .rev()
                .map(|n| {
                    let place = rest % n;
                    rest /= n;
                    place as f64 / (n - 1) as f64
                })
                .collect();
            point.reverse();
            point
        });
        Ok(Proposal::Evaluate(candidates.collect()))
    }
}
