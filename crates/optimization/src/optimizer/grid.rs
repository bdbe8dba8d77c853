//! The optimizer `grid`: evaluates every combination of evenly spaced values.

use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// The simplest optimizer: its points do not depend on the scores.
pub(super) struct FullGrid;

impl FullGrid {
    /// The study's own numbers of points along the parameters if the budget suffices for them; otherwise the largest number of
    /// points along each parameter that the budget allows, the same for all parameters.
    fn points(problem: &OptimizationProblem) -> Vec<usize> {
        let wanted = problem
            .points
            .iter()
            .try_fold(1_usize, |size, points| size.checked_mul(*points));
        if wanted.is_some_and(|size| size <= problem.budget) {
            return problem.points.clone();
        }
        let dimensions = problem.dimensions() as u32;
        let each = (2..=problem.budget)
            .take_while(|n| {
                n.checked_pow(dimensions)
                    .is_some_and(|size| size <= problem.budget)
            })
            .last()
            .unwrap_or(2);
        vec![each; problem.dimensions()]
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

    fn batch(&self, problem: &OptimizationProblem) -> usize {
        Self::points(problem).iter().product()
    }

    fn depends_on_budget(&self) -> bool {
        true
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        if !history.evaluated.is_empty() {
            return Ok(Proposal::Exhausted);
        }
        let points = Self::points(problem);
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
