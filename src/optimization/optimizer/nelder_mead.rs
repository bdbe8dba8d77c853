//! The downhill simplex, from the `argmin` library.

use argmin::core::{CostFunction, IterState, Problem, Solver, State, TerminationStatus};

use super::replay::Replay;
use super::{Brief, History, Optimizer, Proposal, UnitPoint};
use crate::error::{Advice, Error, Result};

/// Nelder–Mead with restarts from the best points of the first design.
pub(super) struct NelderMead;

/// Edge of the first simplex, share of the range.
const EDGE: f64 = 0.12;
/// A simplex whose scores differ by less than this share of the best score has arrived.
const ARRIVED: f64 = 1e-3;
/// Evaluations of one simplex per parameter; rough scores can keep it wandering for ever.
const PATIENCE: usize = 30;

type SolverState = IterState<Vec<f64>, (), (), (), (), f64>;

struct Costs<'a>(&'a Replay<'a>);

impl CostFunction for Costs<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, point: &Vec<f64>) -> std::result::Result<f64, argmin::core::Error> {
        Ok(self.0.cost(point.iter().copied()))
    }
}

fn refused(error: &argmin::core::Error) -> Error {
    Error::conflict(format!("the simplex cannot go on: {error}"))
        .advise(Advice::OtherOptimizer)
        .advise(Advice::OtherSeed)
}

/// `start` and one more point along each axis, towards the middle.
fn simplex(start: &UnitPoint) -> Vec<UnitPoint> {
    let mut corners = vec![start.clone()];
    for axis in 0..start.len() {
        let mut corner = start.clone();
        corner[axis] += if corner[axis] > 0.5 { -EDGE } else { EDGE };
        corners.push(corner);
    }
    corners
}

impl Optimizer for NelderMead {
    fn name(&self) -> &'static str {
        "nelder-mead"
    }

    fn doc(&self) -> &'static str {
        "Downhill simplex (Nelder & Mead 1965, argmin), restarted from the best points of a space-filling first design; one candidate at a time."
    }

    fn design(&self, dimensions: usize) -> usize {
        6 * dimensions
    }

    fn batch(&self, brief: &Brief) -> usize {
        brief.dimensions() + 1
    }

    fn propose(&self, brief: &Brief, history: &History<'_>) -> Result<Proposal> {
        let replay = Replay::new(history.told);
        let middle = vec![0.5; brief.dimensions()];
        let starts = history.best_of_design();
        let scale = starts.first().map_or(1.0, |(_, score)| score.abs());
        for restart in 0.. {
            let start = match starts.len() {
                0 => &middle,
                n => starts[restart % n].0,
            };
            let mut solver = argmin::solver::neldermead::NelderMead::new(simplex(start))
                .with_sd_tolerance((ARRIVED * scale).max(f64::MIN_POSITIVE))
                .map_err(|e| refused(&e))?;
            let mut problem = Problem::new(Costs(&replay));
            let limit = replay.calls() + PATIENCE * brief.dimensions();
            let (mut state, _) = solver
                .init(&mut problem, SolverState::new())
                .map_err(|e| refused(&e))?;
            let first = replay.asked();
            if !first.is_empty() {
                return Ok(Proposal::Evaluate(first));
            }
            while replay.calls() < limit
                && Solver::<Costs<'_>, SolverState>::terminate(&mut solver, &state)
                    == TerminationStatus::NotTerminated
            {
                (state, _) = solver
                    .next_iter(&mut problem, state)
                    .map_err(|e| refused(&e))?;
                // What a step asks for after its first unknown depends on the filler.
                if let Some(next) = replay.asked().into_iter().next() {
                    return Ok(Proposal::Evaluate(vec![next]));
                }
            }
        }
        Ok(Proposal::Exhausted)
    }
}
