//! The answer of a study: the best point, and its uncertainty.

pub(super) mod relation;
pub(super) mod report;
pub(super) mod score;
pub(super) mod uncertainty;
pub(super) mod values;
pub(super) mod verdict;

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use crate::calibration::answer::report::Evidence;
use crate::calibration::exploration::least_squares::LeastSquaresFit;
use crate::calibration::exploration::wave::{leading, scored_runs, with_best_completed};
use crate::calibration::numerics::engines::{explaining_engine, posterior_weights};
use crate::calibration::{
    Audit, Fit, Method, PointScore, Report, Reproduction, Scores, Study, Uncertainty, Validation,
};
use realgap_core::Result;
use realgap_inference::{
    BAND, Emulator, HistoryMatching, LeastSquaresPosterior, ObservationUncertainty, PosteriorDraws,
    Profile, ScoredRun,
};
use realgap_optimization::{Ending, Grid, RunOptions, space_filling};

/// Result of a sweep or of tuning; its `Display` is the report.
#[derive(Debug, Clone)]
pub struct Answer {
    /// How the points were chosen.
    pub method: Method,
    /// Whether the run is complete or was stopped early.
    pub ending: Ending,
    /// Scores of the points evaluated so far.
    pub scores: Scores,
    /// The confidence set; `None` where no point has a score.
    pub uncertainty: Option<Uncertainty>,
    /// Posterior draws of the parameters; `None` where no point has a score.
    pub draws: Option<PosteriorDraws>,
    /// The lowest expected score along each parameter.
    pub profiles: Vec<Profile>,
    /// The report: the best point, verdicts, the effect of numerics, the check by held-out recordings.
    pub report: Report,
    /// What the score is expected to be at any point, and the grid of its parameters.
    surface: Option<(Surface, Grid)>,
}

/// What the score is expected to be at points without a run.
#[derive(Debug, Clone)]
enum Surface {
    /// From an emulator.
    Emulator(Emulator),
    /// From a fit by least squares, as a multiple of this score of its best point.
    LeastSquares(Arc<LeastSquaresPosterior>, f64),
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}

/// The step after the last trial, while nothing is simulated.
pub(in crate::calibration) const INFERRING: &str = "computing the posterior";
/// An expected score above this share of the highest that the emulator tells from others is not told.
const HIGH: f64 = 0.9;
/// Points from which an answer is drawn.
const PLACES: usize = 500;

impl Answer {
    /// Computes the uncertainty of the best of these scores; simulations run on the current rayon pool. `refits`: as
    /// [`Validation::new`] takes them. A fit by least squares has a posterior of its own and needs no emulator.
    pub(in crate::calibration) fn new(
        (study, run): (&Study, &RunOptions<'_>),
        method: Method,
        ending: Ending,
        scores: Scores,
        refits: Option<Vec<PointScore>>,
        least_squares: Option<LeastSquaresFit>,
    ) -> Result<Self> {
        let mut weights = vec![1.0];
        let (scores, emulator) = match ending {
            Ending::Complete if least_squares.is_none() => {
                match Emulator::new(&scored_runs(study, &scores))? {
                    Some(emulator) => {
                        let weighed = study.with_engines_weighed(run, scores, emulator)?;
                        let (scores, emulator, of_engines) = weighed;
                        weights = of_engines;
                        let scores = scores.in_engine(study, explaining_engine(&weights));
                        with_best_completed((study, run), scores, Some(emulator))?
                    }
                    None => with_best_completed((study, run), scores, None)?,
                }
            }
            // An interrupted run is not continued here, and a part of a grid allows no conclusion about the whole.
            _ => (scores, None),
        };
        let emulator = match study.fitted_recordings() {
            // The surrogates of a single recording are runs of the best point, which is known only now.
            1 => emulator.map(|known| known.conditioned_on(&scored_runs(study, &scores))),
            _ => emulator,
        };
        let fit = match study.is_audited() {
            true => Fit::new((study, run), &scores, &method)?,
            false => None,
        };
        let definition = study.definition();
        let uncertainty_of_observations = ObservationUncertainty {
            observations: study.fitted_recordings(),
            discrepancy: fit.as_ref().map_or(0.0, |fit| fit.discrepancy),
        };
        let (positions, mut visited) = leading(study, &scores, emulator.as_ref(), usize::MAX);
        let grid = &definition.grid;
        if method != Method::Sweep && grid.ranges().len() == 2 {
            let cells = (0..grid.len()).map(|index| grid.place_of(&grid.values(index)));
            visited.extend(cells);
        }
        let matching = emulator.as_ref().map(|emulator| {
            let uncertainty = uncertainty_of_observations;
            HistoryMatching::new(
                (emulator, &posterior_weights(&weights)),
                grid,
                &visited,
                uncertainty,
                PLACES,
                definition.seed,
            )
        });
        let judged = matching.as_ref().zip(scores.best);
        let uncertainty = judged
            .map(|(matching, best)| Uncertainty::new(study, &scores, best, (matching, &positions)));
        let draws = judged.map(|(matching, _)| matching.draws(grid, definition.seed));
        let fitted = least_squares.as_ref();
        let uncertainty = uncertainty.or_else(|| fitted?.uncertainty(study));
        let draws = draws.or_else(|| Some(fitted?.draws.clone()));
        let engines = match (judged, emulator.as_ref()) {
            (Some((matching, best)), Some(emulator)) => {
                let known = (uncertainty_of_observations, matching.limit());
                study.engine_preferences(&scores, best, (emulator, &weights), known)
            }
            _ => Vec::new(),
        };
        let profiles = match fitted {
            Some(fitted) => fitted.profiles(study),
            None => profiles(study, &scores, emulator.as_ref(), uncertainty.as_ref()),
        };
        // No more simulations are made after an interruption.
        let (audit, reproduction) = match ending {
            Ending::Complete if study.is_audited() => (
                Audit::new((study, run), &scores, &profiles)?,
                Reproduction::new((study, run), &scores)?,
            ),
            _ => (None, None),
        };
        let evidence = Evidence {
            method: &method,
            ending,
            scores: &scores,
            uncertainty: uncertainty.as_ref(),
            draws: draws.as_ref(),
            engines,
            audit,
            fit,
            validation: Validation::new(study, &scores, refits)?.map(|held| Validation {
                bands: least_squares
                    .as_ref()
                    .and_then(|fitted| fitted.bands.clone()),
                ..held
            }),
            reproduction,
        };
        let report = Report::new(study, &evidence)?;
        let best_score = scores.best.and_then(|best| scores.points[best].score);
        let surface = match (emulator, least_squares) {
            (Some(emulator), _) => Some(Surface::Emulator(emulator)),
            (None, Some(fitted)) => {
                best_score.map(|score| Surface::LeastSquares(Arc::new(fitted.posterior), score))
            }
            (None, None) => None,
        };
        Ok(Self {
            method,
            ending,
            scores,
            uncertainty,
            draws,
            profiles,
            report,
            surface: surface.map(|surface| (surface, grid.clone())),
        })
    }

    /// The expected mean score over equally valid settings at these parameter values, with the ends of its 90 % interval; `None` where
    /// there are too few runs, where the score is so high that nothing more is known, and for a fit by least squares.
    pub fn expected_with_band(&self, values: &[f64]) -> Option<(f64, (f64, f64))> {
        let (Surface::Emulator(emulator), grid) = self.surface.as_ref()? else {
            return None;
        };
        let (point, engine) = (grid.place_of(values), self.scores.engine);
        let (mean, band) = (
            emulator.mean_in(&point, engine),
            emulator.band(&point, engine, BAND),
        );
        // Where the score is high, the emulator knows no more than that.
        (mean < HIGH * emulator.highest()).then_some((mean, band))
    }

    /// The mean difference of net displacements over all equally valid settings at every point of the grid, as all runs let expect,
    /// metres; empty where one setting is run, or where there are too few runs.
    ///
    /// # Errors
    /// As [`Emulator::new`].
    pub fn expected_displacement_errors(&self, study: &Study) -> Result<Vec<f64>> {
        let settings = study.settings();
        if settings.count == 1 {
            return Ok(Vec::new());
        }
        let grid = &study.definition().grid;
        let runs = self.scores.runs.iter().filter_map(|run| {
            Some(ScoredRun {
                point: grid.place_of(&run.values),
                setting: settings.of_trial(run.index).number(),
                variant: settings.engine_of_trial(run.index),
                scores: vec![run.displacement_error_m?],
                surrogate_scores: Vec::new(),
            })
        });
        let Some(emulator) = Emulator::new(&runs.collect::<Vec<_>>())? else {
            return Ok(Vec::new());
        };
        let places = (0..grid.len()).map(|index| grid.place_of(&grid.values(index)));
        let engine = self.scores.engine;
        Ok(places
            .map(|place| emulator.mean_in(&place, engine))
            .collect())
    }

    /// The expected score at these parameter values, whether they were simulated or not; `None` where there are too few runs.
    pub fn expected_score(&self, values: &[f64]) -> Option<f64> {
        let (surface, grid) = self.surface.as_ref()?;
        let point = grid.place_of(values);
        Some(match surface {
            Surface::Emulator(emulator) => emulator.mean_in(&point, self.scores.engine),
            Surface::LeastSquares(posterior, score) => score * posterior.relative_score(&point),
        })
    }
}

/// Points of each kind from which a profile takes the values of the other parameters.
const PROFILED: usize = 150;

/// The profile of every parameter.
fn profiles(
    study: &Study,
    scores: &Scores,
    emulator: Option<&Emulator>,
    uncertainty: Option<&Uncertainty>,
) -> Vec<Profile> {
    let (Some(emulator), Some(uncertainty)) = (emulator, uncertainty) else {
        return Vec::new();
    };
    let grid = &study.definition().grid;
    let unvisited = uncertainty.unvisited.iter();
    let likely = unvisited.clone().filter(|point| point.indistinguishable);
    let likely: Vec<Vec<f64>> = likely
        .take(PROFILED)
        .map(|p| grid.place_of(&p.values))
        .collect();
    let even = space_filling(grid.ranges().len(), 0, PROFILED, study.definition().seed);
    let others: Vec<Vec<f64>> = even.into_iter().chain(likely).collect();
    let ranges = grid.ranges().iter().enumerate();
    ranges
        .map(|(axis, range)| {
            let inside = uncertainty.values_in_set(scores, axis);
            let inside: BTreeSet<usize> = inside.map(|value| range.nearest(value)).collect();
            let of = (emulator, scores.engine);
            Profile::new(of, (axis, range), &others, |cell| inside.contains(&cell))
        })
        .collect()
}
