//! Optimizers: each a pure function from what has been told so far to what should be tried next.
//!
//! An optimizer holds no state. The driver shows it the whole history and gets the next batch; the same history gives the
//! same batch, so a run can be interrupted anywhere and goes on with the same bits. Algorithms that are loops are
//! replayed from the start on every call (`replay`), which costs microseconds where a simulation costs milliseconds.
//!
//! Adding an optimizer is one file and one line in [`OPTIMIZERS`]; tests/contract.rs runs over all of them.

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
pub use gauss_newton::{Quadratic, slopes};
pub use random::space_filling;

use realgap_core::error::Result;
use realgap_core::file::look_up;
use realgap_core::warning::Warning;

/// A point of the searched space: one coordinate a parameter, each in 0 to 1.
pub type UnitPoint = Vec<f64>;

/// A candidate that has been evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedPoint {
    /// Where.
    pub point: UnitPoint,
    /// How far from reality, to be made small; `None` where there is no score (a simulation that diverged).
    pub score: Option<f64>,
    /// Single errors that the score is made of, for who [needs](Optimizer::needs_errors) them; else empty.
    pub errors: Vec<f64>,
}

/// What an optimizer is asked to do.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimizationProblem {
    /// Number of values that a study asks for along each parameter; only a grid cares.
    pub points: Vec<usize>,
    /// Most evaluations in all, those of the first design included.
    pub budget: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// What is known of every parameter beforehand, its median and variance as coordinates; `None` for nothing but the range. Only
    /// least squares ask.
    pub priors: Vec<Option<(f64, f64)>>,
}

impl OptimizationProblem {
    /// Number of parameters.
    pub fn dimensions(&self) -> usize {
        self.points.len()
    }

    /// What is believed beforehand: the medians, else the middle of the ranges.
    fn middle(&self) -> UnitPoint {
        let prior = |axis: usize| self.priors.get(axis).copied().flatten();
        let median = |axis: usize| prior(axis).map_or(0.5, |(median, _)| median.clamp(0.0, 1.0));
        (0..self.dimensions()).map(median).collect()
    }
}

/// Everything told so far.
#[derive(Debug, Clone, Copy)]
pub struct History<'a> {
    /// The space-filling first design, which was not the optimizer's choice.
    pub design: &'a [EvaluatedPoint],
    /// What the optimizer asked for, in its order.
    pub told: &'a [EvaluatedPoint],
}

impl History<'_> {
    /// The design's points with a score, best first; ties by order.
    fn best_of_design(&self) -> Vec<(&UnitPoint, f64)> {
        let mut scored: Vec<(&UnitPoint, f64)> = self
            .design
            .iter()
            .filter_map(|told| told.score.map(|score| (&told.point, score)))
            .collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        scored
    }
}

/// What an optimizer wants next.
#[derive(Debug, Clone, PartialEq)]
pub enum Proposal {
    /// These candidates, at least one; they do not depend on each other and may be evaluated in parallel.
    Evaluate(Vec<UnitPoint>),
    /// Nothing: every candidate it knows has been evaluated.
    Exhausted,
}

/// One optimizer.
pub trait Optimizer: Sync {
    /// The name on the command line.
    fn name(&self) -> &'static str;

    /// One sentence for people, with its source.
    fn doc(&self) -> &'static str;

    /// Smallest space-filling first design for so many parameters; 0 where it goes everywhere by itself. Without one, what lies
    /// far from an optimizer's favourite would stay unknown; ten points a parameter are what a Gaussian process needs
    /// (Loeppky, Sacks & Welch 2009).
    fn design(&self, dimensions: usize) -> usize {
        10 * dimensions
    }

    /// Most candidates in one batch.
    fn batch(&self, brief: &OptimizationProblem) -> usize;

    /// True where what it proposes depends on the budget, so that a larger one is another search.
    fn depends_on_budget(&self) -> bool {
        false
    }

    /// Whether it looks at the single errors that a score is made of.
    fn needs_errors(&self) -> bool {
        false
    }

    /// What the reader of a search should know about how it went.
    fn warning(&self, brief: &OptimizationProblem, history: &History<'_>) -> Option<Warning> {
        let _ = (brief, history);
        None
    }

    /// The loss near its minimum, of an optimizer that knows it; `logs` says how many of the errors belong to each log, in their
    /// order, and is empty where all belong to one.
    fn quadratic(
        &self,
        brief: &OptimizationProblem,
        history: &History<'_>,
        logs: &[usize],
    ) -> Option<Quadratic> {
        let _ = (brief, history, logs);
        None
    }

    /// The next batch.
    ///
    /// # Errors
    /// None of those here; an own optimizer may refuse what it was told.
    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal>;
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

/// The optimizer of those who name none.
pub fn default_optimizer() -> &'static dyn Optimizer {
    &CmaEs
}

/// The optimizer with this name.
///
/// # Errors
/// An unknown name, with the known ones.
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

/// A coordinate brought into 0 to 1 by reflection at the ends, so that bounds hold exactly and no point is piled up on them.
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
    fn reflection_keeps_the_inside_and_never_leaves_the_bounds() {
        assert_eq!([fold(0.0), fold(0.3), fold(1.0)], [0.0, 0.3, 1.0]);
        assert!((fold(1.2) - 0.8).abs() < 1e-15 && (fold(-0.2) - 0.2).abs() < 1e-15);
        for coordinate in [-1e9, -7.7, 3.2, 1e300, f64::INFINITY, f64::NAN] {
            assert!((0.0..=1.0).contains(&fold(coordinate)), "{coordinate}");
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_known_ones() {
        let error = optimizer_by_name("simplex").unwrap_err().to_string();
        assert!(
            error.contains("nelder-mead") && error.contains("cma-es"),
            "{error}"
        );
    }
}
