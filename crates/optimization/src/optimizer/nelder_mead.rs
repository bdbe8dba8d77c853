//! The optimizer `nelder-mead`: the downhill simplex of the library `argmin`.

use std::convert::Infallible;

use argmin::core::{CostFunction, IterState, Problem, Solver, State, TerminationStatus};
use argmin::solver::neldermead;
use argmin_math::{ArgminAdd, ArgminMul, ArgminSub};

use super::replay::{Replay, Unknown};
use super::{History, OptimizationProblem, Optimizer, Proposal, UnitPoint};
use realgap_core::error::{Advice, Error, Result};

/// Nelder–Mead with restarts from the best points of the first design.
pub(super) struct NelderMead;

/// Edge of the initial simplex as a share of the range.
const EDGE: f64 = 0.12;
/// A simplex has converged if the standard deviation of its scores is below this share of the best score.
const CONVERGED: f64 = 1e-3;
/// Largest number of evaluations of one simplex per parameter, because a simplex may never converge on a rough score.
const MAX_EVALUATIONS: usize = 30;

/// A point with the arithmetic that argmin requires.
#[derive(Clone)]
pub(super) struct Corner(UnitPoint);

impl Corner {
    fn with(&self, other: &Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        let axes = self.0.iter().zip(&other.0);
        Self(axes.map(|(a, b)| operation(*a, *b)).collect())
    }
}

impl ArgminAdd<Self, Self> for Corner {
    fn add(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl ArgminSub<Self, Self> for Corner {
    fn sub(&self, other: &Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl ArgminMul<f64, Self> for Corner {
    fn mul(&self, factor: &f64) -> Self {
        self.with(self, |a, _| a * factor)
    }
}

type SolverState = IterState<Corner, (), (), (), (), f64>;

impl CostFunction for &Replay<'_> {
    type Param = Corner;
    type Output = f64;

    fn cost(&self, corner: &Corner) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.scores([corner.0.as_slice()])?[0])
    }
}

/// `start` and one more point along each axis, towards the middle.
fn simplex(start: &UnitPoint) -> Vec<Corner> {
    let mut corners = vec![Corner(start.clone())];
    for axis in 0..start.len() {
        let mut corner = start.clone();
        corner[axis] += if corner[axis] > 0.5 { -EDGE } else { EDGE };
        corners.push(Corner(corner));
    }
    corners
}

/// Runs the algorithm until it needs points that have not been evaluated yet; it then ends with [`Unknown`] as an error of argmin.
fn search(
    dimensions: usize,
    history: &History<'_>,
) -> std::result::Result<Infallible, argmin::core::Error> {
    let replay = Replay::new(history.evaluated);
    let middle = vec![0.5; dimensions];
    let starts = history.best_of_design();
    let scale = starts.first().map_or(1.0, |(_, score)| score.abs());
    let arrived = (CONVERGED * scale).max(f64::MIN_POSITIVE);
    let mut restart = 0;
    loop {
        let start = match starts.len() {
            0 => &middle,
            n => starts[restart % n].0,
        };
        let corners = simplex(start);
        // The corners of the initial simplex are looked up here, because argmin evaluates them one by one and does not pass on an
        // error at this stage.
        replay
            .clone()
            .scores(corners.iter().map(|corner| corner.0.as_slice()))?;
        let limit = replay.answered() + MAX_EVALUATIONS * dimensions;
        let mut solver = neldermead::NelderMead::new(corners).with_sd_tolerance(arrived)?;
        let mut problem = Problem::new(&replay);
        let (mut state, _) = solver.init(&mut problem, SolverState::new())?;
        while replay.answered() < limit
            && Solver::<&Replay<'_>, SolverState>::terminate(&mut solver, &state)
                == TerminationStatus::NotTerminated
        {
            (state, _) = solver.next_iter(&mut problem, state)?;
        }
        restart += 1;
    }
}

impl Optimizer for NelderMead {
    fn name(&self) -> &'static str {
        "nelder-mead"
    }

    fn doc(&self) -> &'static str {
        "Downhill simplex (Nelder & Mead 1965, argmin), restarted from the best points of a space-filling first design; one candidate at a time."
    }

    fn batch(&self, problem: &OptimizationProblem) -> usize {
        problem.dimensions() + 1
    }

    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let Err(ended) = search(problem.dimensions(), history);
        match ended.downcast::<Unknown>() {
            Ok(Unknown(points)) => Ok(Proposal::Evaluate(points)),
            Err(error) => Err(
                Error::conflict(format!("the simplex cannot go on: {error}"))
                    .advise(Advice::OtherOptimizer)
                    .advise(Advice::OtherSeed),
            ),
        }
    }
}
