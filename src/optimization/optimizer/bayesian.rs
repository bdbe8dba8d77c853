//! Bayesian optimisation with Gaussian processes, from the `egobox-ego` library.

use egobox_ego::{EgorServiceBuilder, InfillStrategy, QEiStrategy};
use ndarray::Array2;

use super::{Brief, History, Optimizer, Proposal, Told, UnitPoint, fold};
use crate::error::{Error, Result};

/// Efficient global optimisation.
pub(super) struct Bayesian;

/// Candidates in one batch.
const BATCH: usize = 2;

impl Optimizer for Bayesian {
    fn name(&self) -> &'static str {
        "bayesian"
    }

    fn doc(&self) -> &'static str {
        "Gaussian process with expected improvement (Jones et al. 1998, egobox): fewest simulations, most thought between them; for budgets of a few hundred."
    }

    fn design(&self, dimensions: usize) -> usize {
        5 * dimensions
    }

    fn batch(&self, _brief: &Brief) -> usize {
        BATCH
    }

    fn propose(&self, brief: &Brief, history: &History<'_>) -> Result<Proposal> {
        let n = brief.dimensions();
        let all: Vec<&Told> = history.design.iter().chain(history.told).collect();
        let scores: Vec<f64> = all.iter().filter_map(|told| told.score).collect();
        let worst = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if scores.len() < 2 {
            // Nothing to model yet: fill space further.
            let from = all.len();
            let more = super::space_filling(n, from, from + BATCH, brief.seed);
            return Ok(Proposal::Evaluate(more));
        }
        let x = Array2::from_shape_fn((all.len(), n), |(row, column)| all[row].point[column]);
        // A failed candidate counts as bad as the worst seen: a huge penalty would spoil the process.
        let y = Array2::from_shape_fn((all.len(), 1), |(row, _)| all[row].score.unwrap_or(worst));
        let limits = Array2::from_shape_fn((n, 2), |(_, column)| column as f64);
        let service = EgorServiceBuilder::optimize()
            .configure(|config| {
                config
                    .infill_strategy(InfillStrategy::LogEI)
                    .configure_qei(|qei| qei.batch(BATCH).strategy(QEiStrategy::KrigingBeliever))
                    .seed(brief.seed.wrapping_add(all.len() as u64))
            })
            .min_within(&limits)
            .map_err(|e| Error::conflict(format!("the Gaussian process cannot start: {e}")))?;
        let suggested = service.suggest(&x, &y);
        let candidates: Vec<UnitPoint> = suggested
            .rows()
            .into_iter()
            .map(|row| row.iter().map(|value| fold(*value)).collect())
            .collect();
        Ok(Proposal::Evaluate(candidates))
    }
}
