//! The answer of a study: the best point, and how sure it is.

use std::collections::BTreeSet;
use std::fmt;

use super::inference::Inference;
use super::report::Evidence;
use super::wave::{leading, scored_runs, settled};
use super::{
    Audit, BestDraws, Fit, Method, PointScore, Profile, Report, Reproduction, Scores, Study,
    Uncertainty, Validation,
};
use realgap_core::Result;
use realgap_inference::{Doubt, Emulator};
use realgap_optimization::{Ending, Grid, space_filling};

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
    /// The lowest score to be expected along each parameter.
    pub profiles: Vec<Profile>,
    /// What all of it says: the best point, verdicts, what numerics change, how held-out recordings fare.
    pub report: Report,
    /// The score everywhere, and the parameters that it is known over.
    emulator: Option<(Emulator, Grid)>,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}

/// Places that an answer is drawn from, and points whose implausibility is told.
const PLACES: usize = 500;
const VISITED: usize = 200;

impl Answer {
    /// Works out how sure the best of these scores is; simulations run on the current rayon pool. `refits`: as
    /// [`Validation::new`] wants them.
    pub(super) fn new(
        study: &Study,
        method: Method,
        ending: Ending,
        scores: Scores,
        refits: Option<Vec<PointScore>>,
    ) -> Result<Self> {
        let (mut scores, emulator) = match ending {
            Ending::Complete => {
                let emulator = Emulator::new(&scored_runs(study, &scores))?;
                settled(study, scores, emulator)?
            }
            // Whoever interrupts does not want to wait, and a part of a grid says nothing sure of the whole.
            Ending::Interrupted => (scores, None),
        };
        if let Some(fitted) = method.fitted() {
            // What least squares chose has the least robust loss, whatever the plain score of another point is.
            let chosen = scores.points.iter().position(|p| p.values == fitted);
            scores.best = chosen.or(scores.best);
        }
        let emulator = match study.fitted_recordings() {
            // What might have been recorded is what the best point's runs show, which is known now.
            1 => emulator.map(|known| known.again(&scored_runs(study, &scores))),
            _ => emulator,
        };
        let fit = Fit::new(study, &scores, &method)?;
        let definition = study.definition();
        let doubt = Doubt {
            recordings: study.fitted_recordings(),
            discrepancy: fit.as_ref().map_or(0.0, |fit| fit.discrepancy),
        };
        let (positions, visited) = leading(study, &scores, emulator.as_ref(), VISITED);
        let grid = &definition.grid;
        let inference = emulator.as_ref().map(|emulator| {
            Inference::new(emulator, grid, &visited, doubt, PLACES, definition.seed)
        });
        let judged = inference.as_ref().zip(scores.best);
        let uncertainty = judged.map(|(inference, best)| {
            Uncertainty::new(study, &scores, best, (inference, &positions))
        });
        let draws = judged.map(|(inference, _)| inference.draws(grid, definition.seed));
        let engines = match (judged, emulator.as_ref()) {
            (Some((inference, best)), Some(emulator)) => {
                study.wishes(&scores, best, emulator, (doubt, inference.limit))
            }
            _ => Vec::new(),
        };
        let profiles = profiles(study, &scores, emulator.as_ref(), uncertainty.as_ref());
        // Whoever interrupts does not want to wait for more simulations.
        let (audit, reproduction) = match ending {
            Ending::Complete => (
                Audit::new(study, &scores, &profiles)?,
                Reproduction::new(study, &scores)?,
            ),
            Ending::Interrupted => (None, None),
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
            validation: Validation::new(study, &scores, refits)?,
            reproduction,
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
            emulator: emulator.map(|emulator| (emulator, grid.clone())),
        })
    }

    /// The score to be expected at these parameter values, whether they were simulated or not; `None` where too little was.
    pub fn expected_score(&self, values: &[f64]) -> Option<f64> {
        let (emulator, grid) = self.emulator.as_ref()?;
        Some(emulator.mean(&grid.place_of(values)))
    }
}

/// Places whose other parameters a profile looks at.
const PROFILED: usize = 150;
/// Standard deviations to each side that hold 90 %.
const BAND: f64 = 1.645;

/// The lowest score to be expected at every value of each parameter.
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
    let places = uncertainty.unvisited.iter();
    let likely = places.clone().filter(|place| place.indistinguishable);
    let likely: Vec<Vec<f64>> = likely
        .take(PROFILED)
        .map(|p| grid.place_of(&p.values))
        .collect();
    let even = space_filling(grid.ranges().len(), 0, PROFILED, study.definition().seed);
    let others: Vec<Vec<f64>> = even.into_iter().chain(likely).collect();
    let ranges = grid.ranges().iter().enumerate();
    ranges
        .map(|(axis, range)| {
            let points = scores.points.iter().zip(&uncertainty.indistinguishable);
            let visited = points.map(|(point, is_in)| (point.values[axis], *is_in));
            let places = places
                .clone()
                .map(|p| (p.values[axis], p.indistinguishable));
            let inside = visited.chain(places).filter(|(_, is_in)| *is_in);
            let inside: BTreeSet<usize> = inside.map(|(value, _)| range.nearest(value)).collect();
            let lowest = |value: f64| {
                let here = others.iter().map(|place| {
                    let mut place = place.clone();
                    place[axis] = range.coordinate(value);
                    (emulator.mean(&place), place)
                });
                let lowest = here.min_by(|a, b| a.0.total_cmp(&b.0));
                lowest.map_or((f64::NAN, (f64::NAN, f64::NAN)), |(score, place)| {
                    (score, emulator.band(&place, BAND))
                })
            };
            Profile::new(range, lowest, |cell| inside.contains(&cell))
        })
        .collect()
}
