//! Covariance matrix adaptation, from the `cmaes` library.

use cmaes::{CMAESOptions, DVector};

use super::random::space_filling;
use super::replay::Replay;
use super::{Brief, History, Optimizer, Proposal};
use crate::error::{Error, Result};

/// CMA-ES with restarts of growing population.
pub(super) struct CmaEs;

/// First step size, share of the range: without a first design the whole range, with one its neighbourhood.
const WIDE: f64 = 0.3;
const NEAR: f64 = 0.15;

/// The usual 4 + 3 ln n (Hansen 2016).
fn population(dimensions: usize) -> usize {
    4 + (3.0 * (dimensions as f64).ln()).floor() as usize
}

impl Optimizer for CmaEs {
    fn name(&self) -> &'static str {
        "cma-es"
    }

    fn doc(&self) -> &'static str {
        "Covariance matrix adaptation (Hansen 2016, cmaes), reflected at the bounds, restarted with twice the population when it has converged."
    }

    fn batch(&self, brief: &Brief) -> usize {
        population(brief.dimensions())
    }

    fn propose(&self, brief: &Brief, history: &History<'_>) -> Result<Proposal> {
        let replay = Replay::new(history.told);
        let n = brief.dimensions();
        for restart in 0_usize.. {
            let best = history.best_of_design();
            let (mean, step) = match (restart, best.first()) {
                (0, Some((point, _))) => ((*point).clone(), NEAR),
                (0, None) => (vec![0.5; n], WIDE),
                _ => {
                    let mut starts = space_filling(n, restart, restart + 1, brief.seed);
                    (starts.swap_remove(0), WIDE)
                }
            };
            let mut solver = CMAESOptions::new(mean, step)
                .population_size(population(n) << restart.min(10))
                .seed(brief.seed.wrapping_add(restart as u64))
                .build(|point: &DVector<f64>| replay.cost(point.iter().copied()))
                .map_err(|e| Error::conflict(format!("CMA-ES cannot start: {e:?}")))?;
            loop {
                let ended = solver.next().is_some();
                let asked = replay.asked();
                if !asked.is_empty() {
                    return Ok(Proposal::Evaluate(asked));
                }
                if ended {
                    break;
                }
            }
        }
        Ok(Proposal::Exhausted)
    }
}
