//! The answer of a fit by least squares: runs that check its posterior, and what follows from it.

use rayon::prelude::*;

use crate::calibration::evaluation::band::Bands;
use crate::calibration::exploration::information_gain::FitPrecision;
use crate::calibration::exploration::wave::next_trial;
use crate::calibration::{PosteriorDraws, Profile, Scores, Study, Uncertainty};
use realgap_core::unit::number;
use realgap_core::{Code, Result, Warning};
use realgap_inference::{
    Agreement, LEVEL, LeastSquaresEstimate, LeastSquaresPosterior, RUNS_OF_NUMERICS, most_checks,
};
use realgap_optimization::{
    Ending, EvaluatedPoint, Linearisation, OptimizationProblem, RunOptions, UnitPoint,
};
use realgap_simulation::Experiment;
use realgap_store::Trial;

/// Name of the step that runs points for the posterior.
const CHECKING: &str = "checking the posterior";

/// A fit by least squares with its posterior.
#[derive(Debug)]
pub(in crate::calibration) struct LeastSquaresFit {
    pub posterior: LeastSquaresPosterior,
    /// The posterior's draws; every interval, correlation and picture of the answer is one of these.
    pub draws: PosteriorDraws,
    pub estimates: Vec<LeastSquaresEstimate>,
    /// The scores with the runs that checked the posterior; the best point is that of the smallest robust loss.
    pub scores: Scores,
    /// Where recordings that were held out should lie.
    pub bands: Option<Bands>,
    /// For the information of each recording.
    pub precision: FitPrecision,
    /// Values of the simulated points that belong to the confidence set.
    in_set: Vec<Vec<f64>>,
}

impl LeastSquaresFit {
    /// From the points where descents ended; `None` without one. No runs are made after an interruption.
    ///
    /// # Errors
    /// Those of the runs.
    pub fn new(
        (study, run): (&Study, &RunOptions<'_>),
        (problem, evaluated): (&OptimizationProblem, &[EvaluatedPoint]),
        linearisations: &[Linearisation],
        (scores, ending): (&Scores, Ending),
    ) -> Result<Option<Self>> {
        let grid = &study.definition().grid;
        let mut checks: Vec<Trial> = Vec::new();
        let mut known = evaluated.to_vec();
        let most = match ending {
            Ending::Complete if study.is_audited() => {
                most_checks(problem.dimensions(), evaluated.len())
            }
            _ => 0,
        };
        let mut evaluate = |points: &[UnitPoint]| {
            let from = next_trial(study, scores) + checks.len();
            let mut open: Vec<UnitPoint> = points.to_vec();
            open.retain(|point| known.iter().all(|one: &EvaluatedPoint| one.point != *point));
            open.dedup();
            let step = run.step(CHECKING, open.len());
            let trials = open.par_iter().enumerate().map(|(number, point)| {
                let trial = study.simulate_trial(from + number, grid.values_at(point), true);
                step.count();
                trial
            });
            for (point, trial) in open.iter().zip(trials.collect::<Result<Vec<Trial>>>()?) {
                known.push(EvaluatedPoint {
                    point: point.clone(),
                    score: None,
                    errors: study
                        .errors_of(&trial)
                        .map_or_else(Vec::new, |known| known.0),
                });
                checks.push(trial);
            }
            let errors = points.iter().map(|point| {
                let one = known.iter().find(|one| one.point == *point)?;
                (!one.errors.is_empty()).then(|| one.errors.clone())
            });
            Ok(errors.collect())
        };
        let posterior =
            LeastSquaresPosterior::new(problem, evaluated, linearisations, (&mut evaluate, most))?;
        let Some(mut posterior) = posterior else {
            return Ok(None);
        };
        let best = grid.values_at(posterior.best());
        if ending == Ending::Complete && study.is_audited() {
            let simulator = study.simulator();
            let usual = &study.cases()[0].experiment;
            let mut factors = [0.5, 0.25].into_iter();
            if factors.all(|factor| simulator.refine(&mut usual.clone(), factor)) {
                let step = run.step("fitting with finer timesteps", RUNS_OF_NUMERICS);
                posterior = posterior.with_numerics(&mut |point, factor| {
                    let finer = |e: &mut Experiment| {
                        let _is_finer = simulator.refine(e, factor);
                    };
                    let trial = study.simulate_changed(&grid.values_at(point), finer, true)?;
                    step.count();
                    Ok(study.errors_of(&trial).map(|(errors, _)| errors))
                })?;
            } else {
                let others = study.errors_of_other_settings(&best, run)?;
                posterior = posterior.with_variants(&others);
            }
            posterior = posterior.with_variants(&study.errors_of_other_starts(&best, run)?);
        }
        let mut scores = scores.with_more(study, &checks)?;
        let chosen = scores.points.iter().position(|point| point.values == best);
        scores.best = chosen.or(scores.best);
        let draws = posterior.posterior(grid, problem.seed);
        let bands = match ending {
            Ending::Complete if study.is_audited() => {
                Bands::new((study, run), (&best, &draws), &posterior)?
            }
            _ => None,
        };
        let in_set = known
            .iter()
            .filter(|one| posterior.is_in_set(&one.point, &one.errors, LEVEL));
        let in_set = in_set.map(|one| grid.values_at(&one.point)).collect();
        Ok(Some(Self {
            estimates: LeastSquaresEstimate::all(grid, &posterior, &draws),
            precision: precision(problem, &posterior),
            posterior,
            draws,
            scores,
            bands,
            in_set,
        }))
    }

    /// The confidence set: of the simulated points those whose deviance is low enough, and draws beside them.
    pub fn uncertainty(&self, study: &Study) -> Option<Uncertainty> {
        let best = self.scores.best?;
        let is_in = |values: &Vec<f64>| self.in_set.contains(values);
        let set = self.scores.points.iter().map(|point| is_in(&point.values));
        let set: Vec<bool> = set.collect();
        Some(Uncertainty::of_draws(
            study,
            &self.scores,
            (best, set),
            &self.draws,
        ))
    }

    /// The profile of every parameter.
    pub fn profiles(&self, study: &Study) -> Vec<Profile> {
        let best = self
            .scores
            .best
            .and_then(|best| self.scores.points[best].score);
        let Some(score) = best else {
            return Vec::new();
        };
        let ranges = study.definition().grid.ranges().iter().enumerate();
        let profiles = ranges.map(|(axis, range)| {
            let parts = self.draws.intervals(axis, LEVEL);
            let inside = |value: f64| {
                parts
                    .iter()
                    .any(|(low, high)| (*low..=*high).contains(&value))
            };
            Profile::of_least_squares(&self.posterior, (axis, range), score, inside)
        });
        profiles.collect()
    }

    /// What the reader should know about the posterior.
    pub fn warnings(&self) -> Vec<Warning> {
        let agreement = self.agreement();
        let open = (!agreement.has_converged()).then(|| {
            let why = match agreement.may_be_local() {
                true => format!(
                    "the fit may have ended in a wrong minimum: its errors are {} times as large as the noise that the recordings show, and no second descent ended there",
                    number(agreement.systematic)
                ),
                false => format!(
                    "the fit had not ended when its budget did: its next step would be {:.0} standard deviations long",
                    agreement.remaining
                ),
            };
            Code::NotConverged.warning(format!("{why}, so no parameter is called determined; a larger budget tries more"))
        });
        let doubted = agreement.excess.filter(|_| !agreement.holds()).map(|excess| {
            Code::UnconfirmedPosterior.warning(format!(
                "{} runs at draws of the posterior fit worse than it promises, by {excess:.1} per parameter (twice the log-likelihood): its shape is known roughly only",
                agreement.checked
            ))
        });
        open.into_iter().chain(doubted).collect()
    }

    /// How well runs at some draws agree with the posterior.
    pub fn agreement(&self) -> Agreement {
        self.posterior.agreement()
    }
}

/// The precision of errors and parameters that the fit rests on.
fn precision(problem: &OptimizationProblem, posterior: &LeastSquaresPosterior) -> FitPrecision {
    let (variances, inflation) = posterior.noise();
    let mut channel_variances = Vec::new();
    let mut first = 0;
    for block in &problem.error_blocks {
        if channel_variances.len() <= block.channel {
            channel_variances.resize(block.channel + 1, None);
        }
        let variance = variances.get(first).copied();
        channel_variances[block.channel] = variance.map(|variance| variance * inflation);
        first += block.count;
    }
    FitPrecision {
        channel_variances,
        prior: posterior.prior_precisions(),
    }
}
