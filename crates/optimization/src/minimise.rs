//! An optimizer on a function that is cheap enough to be evaluated at once.

use rayon::prelude::*;

use super::optimizer::{
    EvaluatedPoint, History, OptimizationProblem, Optimizer, Proposal, UnitPoint,
};
use realgap_core::error::Result;

/// Every point that the optimizer asked for until its budget was spent, in its order, with its score.
///
/// ```
/// use realgap_optimization::{OptimizationProblem, minimise, optimizer_by_name};
///
/// let brief = OptimizationProblem { points: vec![2], budget: 100, seed: 1, priors: Vec::new() };
/// let told = minimise(optimizer_by_name("cma-es")?, &brief, |point| Some((point[0] - 0.3).powi(2)))?;
/// let best = told.iter().filter_map(|told| told.score).fold(f64::INFINITY, f64::min);
/// assert!(best < 1e-6);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// As [`Optimizer::propose`].
pub fn minimise(
    optimizer: &dyn Optimizer,
    brief: &OptimizationProblem,
    score: impl Fn(&UnitPoint) -> Option<f64> + Sync,
) -> Result<Vec<EvaluatedPoint>> {
    let mut told: Vec<EvaluatedPoint> = Vec::new();
    while told.len() < brief.budget {
        let history = History {
            design: &[],
            told: &told,
        };
        let Proposal::Evaluate(points) = optimizer.propose(brief, &history)? else {
            break;
        };
        let scored = points.into_par_iter().map(|point| EvaluatedPoint {
            score: score(&point),
            point,
            errors: Vec::new(),
        });
        told.par_extend(scored);
    }
    Ok(told)
}
