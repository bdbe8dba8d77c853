//! Runs an optimizer on a function that is cheap to evaluate.

use rayon::prelude::*;

use super::optimizer::{
    EvaluatedPoint, History, OptimizationProblem, Optimizer, Proposal, UnitPoint,
};
use realgap_core::error::Result;

/// Runs the optimizer until its budget is spent and returns every point that it proposed, with its score, in the order of the
/// proposals.
///
/// ```
/// use realgap_optimization::{OptimizationProblem, minimise, optimizer_by_name};
///
/// let problem = OptimizationProblem { points: vec![2], budget: 100, seed: 1, priors: Vec::new(), error_blocks: Vec::new(), own: None };
/// let evaluated = minimise(optimizer_by_name("cma-es")?, &problem, |point| Some((point[0] - 0.3).powi(2)))?;
/// let best = evaluated.iter().filter_map(|one| one.score).fold(f64::INFINITY, f64::min);
/// assert!(best < 1e-6);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// As [`Optimizer::propose`].
pub fn minimise(
    optimizer: &dyn Optimizer,
    problem: &OptimizationProblem,
    score: impl Fn(&UnitPoint) -> Option<f64> + Sync,
) -> Result<Vec<EvaluatedPoint>> {
    let mut evaluated: Vec<EvaluatedPoint> = Vec::new();
    while evaluated.len() < problem.budget {
        let history = History {
            design: &[],
            evaluated: &evaluated,
        };
        let Proposal::Evaluate(points) = optimizer.propose(problem, &history)? else {
            break;
        };
        let scored = points.into_par_iter().map(|point| EvaluatedPoint {
            score: score(&point),
            point,
            errors: Vec::new(),
        });
        evaluated.par_extend(scored);
    }
    Ok(evaluated)
}
