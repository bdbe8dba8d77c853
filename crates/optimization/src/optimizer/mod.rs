//! Optimizers: each is a pure function from the history of evaluated points to the next points to evaluate.
//!
//! An optimizer has no state. The driver passes it the whole history and receives the next batch. The same history gives the
//! same batch, so a run that is interrupted at any point continues with the same bits. Algorithms that are written as loops are
//! replayed from the start on every call (`replay`), which takes microseconds, while a simulation takes milliseconds.
//!
//! A new optimizer is one file and one line in [`OPTIMIZERS`]; tests/contract.rs tests all of them.

mod bayesian;
mod cma_es;
mod expected_improvement;
mod gauss_newton;
mod grid;
mod nelder_mead;
mod particle_swarm;
mod random;
mod replay;

use bayesian::Bayesian;
use cma_es::CmaEs;
use gauss_newton::GaussNewton;
use grid::FullGrid;
use nelder_mead::NelderMead;
use particle_swarm::Swarm;
use random::Random;

pub use bayesian::thin;
pub use gauss_newton::{
    ErrorBlock, Linearisation, blocks_of, error_scales, minimum_within, robust_loss, robust_slope,
    slopes,
};
pub use random::space_filling;

use realgap_core::error::Result;
use realgap_core::file::look_up;
use realgap_core::warning::Warning;

/// A point of the search space: one coordinate from 0 to 1 for each parameter.
pub type UnitPoint = Vec<f64>;

/// A candidate that has been evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedPoint {
    /// The coordinates of the candidate.
    pub point: UnitPoint,
    /// The score, which is to be minimised (the distance from reality); `None` if there is no score because the simulation
    /// diverged.
    pub score: Option<f64>,
    /// The residuals from which the score is computed, for optimizers that [need](Optimizer::needs_errors) them; otherwise
    /// empty.
    pub errors: Vec<f64>,
}

/// The problem that an optimizer solves: the parameters, the budget, the seed and prior knowledge.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimizationProblem {
    /// Number of values along each parameter that a study asks for; only the grid uses it.
    pub points: Vec<usize>,
    /// Largest number of evaluations in all, including those of the initial design.
    pub budget: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Prior of every parameter, as median and variance of its coordinate; `None` if only the range is known. Only the least-squares
    /// optimizer uses it.
    pub priors: Vec<Option<(f64, f64)>>,
    /// The channels and logs of the errors, in their order; empty if all errors are of one channel and log. Only the least-squares
    /// optimizer uses it.
    pub error_blocks: Vec<ErrorBlock>,
    /// The point that is known without a fit, e.g. a robot's values in its own file; it is the first point of the fit.
    pub own: Option<UnitPoint>,
}

/// Most parameters for which least squares have several starts.
const FEW: usize = 8;

impl OptimizationProblem {
    /// Number of parameters.
    pub fn dimensions(&self) -> usize {
        self.points.len()
    }

    /// Whether least squares descend from the best of several points, and then from others: not for many parameters, where budgets
    /// allow one descent, and not with priors, where what is known says where to begin.
    pub fn has_several_starts(&self) -> bool {
        self.dimensions() <= FEW && self.priors.iter().all(Option::is_none)
    }

    /// The point at which a fit begins: the medians of the priors, else the own values if they are known, else the middle. A
    /// parameter about which the recordings say nothing then stays at its own value.
    fn beginning(&self) -> UnitPoint {
        let Some(own) = &self.own else {
            return self.middle();
        };
        let prior = |axis: usize| self.priors.get(axis).copied().flatten();
        let at = |(axis, own): (usize, &f64)| {
            prior(axis).map_or(*own, |(median, _)| median.clamp(0.0, 1.0))
        };
        own.iter().enumerate().map(at).collect()
    }

    /// The medians of the priors; the middle of the range for a parameter without a prior.
    fn middle(&self) -> UnitPoint {
        let prior = |axis: usize| self.priors.get(axis).copied().flatten();
        let median = |axis: usize| prior(axis).map_or(0.5, |(median, _)| median.clamp(0.0, 1.0));
        (0..self.dimensions()).map(median).collect()
    }
}

/// All points that have been evaluated so far.
#[derive(Debug, Clone, Copy)]
pub struct History<'a> {
    /// The points of the space-filling initial design, which the optimizer did not choose.
    pub design: &'a [EvaluatedPoint],
    /// The points that the optimizer proposed, in the order of its proposals.
    pub evaluated: &'a [EvaluatedPoint],
}

impl History<'_> {
    /// The points of the initial design that have a score, best first; points with equal scores keep their order.
    fn best_of_design(&self) -> Vec<(&UnitPoint, f64)> {
        let mut scored: Vec<(&UnitPoint, f64)> = self
            .design
            .iter()
            .filter_map(|one| one.score.map(|score| (&one.point, score)))
            .collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        scored
    }
}

/// The next step that an optimizer proposes.
#[derive(Debug, Clone, PartialEq)]
pub enum Proposal {
    /// Evaluate these candidates, at least one; they do not depend on each other and may be evaluated in parallel.
    Evaluate(Vec<UnitPoint>),
    /// Stop: the optimizer has no further candidates.
    Exhausted,
}

/// An optimization algorithm.
pub trait Optimizer: Sync {
    /// The name on the command line.
    fn name(&self) -> &'static str;

    /// One sentence that describes the algorithm to users, with its source in the literature.
    fn doc(&self) -> &'static str;

    /// Smallest number of points of the space-filling initial design for this number of parameters; 0 for an algorithm that covers
    /// the whole space by itself. Without an initial design, the regions far from the optimum would stay unexplored. Ten points for
    /// each parameter are what a Gaussian process needs (Loeppky, Sacks & Welch 2009).
    fn design(&self, dimensions: usize) -> usize {
        10 * dimensions
    }

    /// Largest number of candidates in one batch.
    fn batch(&self, problem: &OptimizationProblem) -> usize;

    /// Whether the proposals depend on the budget, so that a search with a larger budget has different points.
    fn depends_on_budget(&self) -> bool {
        false
    }

    /// Whether the algorithm uses the residuals from which a score is computed.
    fn needs_errors(&self) -> bool {
        false
    }

    /// A warning about the course of a search, if there is reason for one.
    fn warning(&self, problem: &OptimizationProblem, history: &History<'_>) -> Option<Warning> {
        let _ = (problem, history);
        None
    }

    /// The errors and their derivatives at the points where searches ended, the best point first; empty for an algorithm that takes no
    /// derivatives of errors.
    fn linearisations(
        &self,
        problem: &OptimizationProblem,
        history: &History<'_>,
    ) -> Vec<Linearisation> {
        let _ = (problem, history);
        Vec::new()
    }

    /// The next batch.
    ///
    /// # Errors
    /// The library behind the optimizer fails, or an optimizer of a user refuses the evaluated points.
    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal>;
}

/// All optimizers.
pub const OPTIMIZERS: &[&dyn Optimizer] = &[
    &FullGrid,
    &Random,
    &NelderMead,
    &Swarm,
    &CmaEs,
    &Bayesian,
    &GaussNewton,
];

/// The optimizer that is used if the user names none.
pub fn default_optimizer() -> &'static dyn Optimizer {
    &CmaEs
}

/// The optimizer with this name.
///
/// # Errors
/// An unknown name; the error lists the known names.
pub fn optimizer_by_name(name: &str) -> Result<&'static dyn Optimizer> {
    look_up("optimizer", name, OPTIMIZERS.iter().copied(), |optimizer| {
        optimizer.name()
    })
    .map_err(|error| error.field("optimizer"))
}

impl std::fmt::Debug for dyn Optimizer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Optimizer({})", self.name())
    }
}

/// Brings a coordinate into 0 to 1 by reflection at the ends, so that the bounds hold exactly and points do not accumulate on them.
fn fold(coordinate: f64) -> f64 {
    if !coordinate.is_finite() {
        return 0.5;
    }
    let within_two = coordinate.rem_euclid(2.0);
    if within_two > 1.0 {
        2.0 - within_two
    } else {
        within_two
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflection_keeps_inner_coordinates_and_never_leaves_the_bounds() {
        assert_eq!([fold(0.0), fold(0.3), fold(1.0)], [0.0, 0.3, 1.0]);
        assert!((fold(1.2) - 0.8).abs() < 1e-15 && (fold(-0.2) - 0.2).abs() < 1e-15);
        for coordinate in [-1e9, -7.7, 3.2, 1e300, f64::INFINITY, f64::NAN] {
            assert!((0.0..=1.0).contains(&fold(coordinate)), "{coordinate}");
        }
    }

    #[test]
    fn the_error_for_an_unknown_optimizer_lists_the_known_names() {
        let error = optimizer_by_name("simplex").unwrap_err().to_string();
        assert!(
            error.contains("nelder-mead") && error.contains("cma-es"),
            "{error}"
        );
    }
}
