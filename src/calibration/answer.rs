//! The answer of a study: the best point, and how sure it is.

use std::fmt;

use rayon::prelude::*;

use super::audit::Audit;
use super::definition::StartRule;
use super::method::Method;
use super::posterior::{BestDraws, ScoredPoint};
use super::profile::Profile;
use super::report::{Evidence, Report};
use super::score::Scores;
use super::study::Study;
use super::uncertainty::{
    LEVEL, Uncertainty, bootstrap_indistinguishable, spread_indistinguishable,
};
use super::validation::Validation;
use crate::error::Result;
use crate::optimization::Ending;
use crate::simulation::Noise;
use crate::statistics::standard_deviation;

/// Result of a sweep or of tuning; its `Display` is the report.
#[derive(Debug, Clone)]
pub struct Answer {
    /// How the points were chosen.
    pub method: Method,
    /// Complete, or stopped early.
    pub ending: Ending,
    /// Scores of the points evaluated so far.
    pub scores: Scores,
    /// What cannot be told apart from the best; `None` where nothing has a score.
    pub uncertainty: Option<Uncertainty>,
    /// Where the best lies when reality is sampled again; `None` where nothing has a score.
    pub draws: Option<BestDraws>,
    /// The best score along each parameter.
    pub profiles: Vec<Profile>,
    /// What all of it says: the best point, verdicts, what numerics change, how held-out recordings fare.
    pub report: Report,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}

/// Perturbed repeats of the best point: how much a score depends on the very start.
const REPEATS: u64 = 16;

impl Answer {
    /// Works out how sure the best of these scores is; simulations run on the current rayon pool.
    pub(super) fn new(
        study: &Study,
        method: Method,
        ending: Ending,
        scores: Scores,
    ) -> Result<Self> {
        let fitted = fitted_scores(study, &scores);
        let uncertainty = match scores.best {
            Some(best) => Some(uncertainty(study, &scores, &fitted, best)?),
            None => None,
        };
        let draws = uncertainty.as_ref().and_then(|uncertainty| {
            let points: Vec<ScoredPoint<'_>> = scores
                .points
                .iter()
                .zip(&fitted)
                .filter_map(|(point, fitted)| {
                    Some(ScoredPoint {
                        values: &point.values,
                        recordings: fitted.as_deref()?,
                    })
                })
                .collect();
            let definition = study.definition();
            BestDraws::new(
                &definition.grid,
                &points,
                uncertainty.simulation_sd,
                definition.seed,
            )
        });
        let profiles = profiles(study, &scores, uncertainty.as_ref());
        let audit = match ending {
            Ending::Complete => Audit::new(study, &scores, &profiles)?,
            // Whoever interrupts does not want to wait for more simulations.
            Ending::Interrupted => None,
        };
        let evidence = Evidence {
            method: &method,
            ending,
            scores: &scores,
            uncertainty: uncertainty.as_ref(),
            draws: draws.as_ref(),
            audit,
            validation: Validation::new(study, &scores)?,
        };
        let report = Report::new(study, &evidence)?;
        Ok(Self {
            method,
            ending,
            scores,
            uncertainty,
            draws,
            profiles,
            report,
        })
    }
}

/// Per point the scores of the recordings that are fitted.
fn fitted_scores(study: &Study, scores: &Scores) -> Vec<Option<Vec<f64>>> {
    scores
        .points
        .iter()
        .map(|point| point.score.map(|_| study.part_of(&point.recordings, false)))
        .collect()
}

fn profiles(study: &Study, scores: &Scores, uncertainty: Option<&Uncertainty>) -> Vec<Profile> {
    let ranges = study.definition().grid.ranges().iter().enumerate();
    ranges
        .map(|(dimension, range)| {
            let points = scores.points.iter().enumerate().map(|(position, point)| {
                let inside = uncertainty.is_some_and(|u| u.indistinguishable[position]);
                (point.values[dimension], point.score, inside)
            });
            Profile::new(range, points)
        })
        .collect()
}

fn uncertainty(
    study: &Study,
    scores: &Scores,
    fitted: &[Option<Vec<f64>>],
    best: usize,
) -> Result<Uncertainty> {
    let definition = study.definition();
    let values = &scores.points[best].values;
    if study.fitted_recordings() >= 2 {
        // Where every recording has its own start, each score is a draw of its own and the bootstrap sees the
        // noise of single simulations; one simulation for all recordings hides it.
        let simulation_sd = match definition.start {
            StartRule::Settled => {
                standard_deviation(&repeats(study, scores, values, &Noise::careful_start())?)
            }
            StartRule::FromRecording => 0.0,
        };
        return Ok(bootstrap_indistinguishable(
            fitted,
            best,
            simulation_sd,
            LEVEL,
            definition.seed,
        ));
    }
    let repeats = repeats(study, scores, values, &Noise::careful_repeat())?;
    let all: Vec<Option<f64>> = scores.points.iter().map(|point| point.score).collect();
    Ok(spread_indistinguishable(&all, best, &repeats, LEVEL))
}

/// Scores of repeats of the best point; diverged ones are left out.
///
/// Every repeat starts a little differently and takes another timestep, from the study's down to half of it:
/// for a walking robot the timestep does not converge (docs/fidelity.md), so a finer one is as good a choice,
/// and what it changes belongs to the uncertainty.
fn repeats(study: &Study, scores: &Scores, values: &[f64], noise: &Noise) -> Result<Vec<f64>> {
    let set = study.parameter_set(values);
    let repeats: Vec<Option<f64>> = (0..REPEATS)
        .into_par_iter()
        .map(|repeat| {
            let timestep_factor = 0.5_f64.powf(repeat as f64 / (REPEATS - 1) as f64);
            let row = study.simulate_perturbed(&set, noise, repeat, timestep_factor)?;
            let Some(result) = row.completed() else {
                return Ok(None);
            };
            let scores = scores.of_result(study, values, 0, result)?;
            Ok(Some(scores.iter().sum::<f64>() / scores.len() as f64))
        })
        .collect::<Result<_>>()?;
    Ok(repeats.into_iter().flatten().collect())
}
