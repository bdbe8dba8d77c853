//! What each engine would answer by itself: whether an answer of both holds in both.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use super::score::Scores;
use super::setting::Setting;
use super::study::Study;
use super::values::by_name;
use realgap_core::error::Result;
use realgap_core::statistics::{mean, standard_deviation, student_quantile};
use realgap_core::unit::{Unit, quantity};
use realgap_core::warning::{Code, Warning};

/// How sure it has to be that an engine wants something else.
const LEVEL: f64 = 0.975;

/// One engine's part in an answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EngineAnswer {
    /// Engine and version.
    pub engine: &'static str,
    /// How many of the equally valid settings are its own.
    pub settings: usize,
    /// Mean score of its settings at the answer of all engines.
    pub score: f64,
    /// Where its own runs are best, smoothed over their neighbours.
    pub parameters: BTreeMap<String, f64>,
    /// Mean score of its settings there.
    pub own_score: f64,
    /// Whether that is lower by more than its settings part (Student's t, 97.5 %).
    pub differs: bool,
}

impl EngineAnswer {
    /// The warning of an engine that wants something else.
    pub(super) fn warning(&self, unit: Unit) -> Option<Warning> {
        let values: Vec<String> = (self.parameters.iter())
            .map(|(name, value)| format!("{name} = {value:.4}"))
            .collect();
        let message = format!(
            "{} by itself wants {}: {} there, {} at the answer of both",
            self.engine,
            values.join(", "),
            quantity(self.own_score, unit),
            quantity(self.score, unit)
        );
        self.differs
            .then(|| Warning::new(Code::EnginesDiffer, message))
    }
}

/// What each engine says to the answer; nothing where one engine simulated all of it.
///
/// # Errors
/// As [`Study::simulate`].
pub(super) fn engine_answers(study: &Study, scores: &Scores) -> Result<Vec<EngineAnswer>> {
    let settings = study.settings();
    let engines = settings.engines(&study.cases()[0].experiment);
    let Some(best) = scores.best.filter(|_| engines.len() > 1) else {
        return Ok(Vec::new());
    };
    let answer = &scores.points[best].values;
    let mut answers = Vec::new();
    for (engine, numbers) in engines {
        let Some(own) = own_best(study, scores, &numbers) else {
            continue;
        };
        let here = scores_with(study, scores, answer, &numbers)?;
        let there = scores_with(study, scores, &own, &numbers)?;
        let pairs: Vec<(f64, f64)> = (here.iter().zip(&there))
            .filter_map(|(here, there)| Some(((*here)?, (*there)?)))
            .collect();
        if pairs.len() < 2 {
            continue;
        }
        let gains: Vec<f64> = pairs.iter().map(|(here, there)| here - there).collect();
        let n = gains.len() as f64;
        let doubt = student_quantile(LEVEL, n - 1.0) * standard_deviation(&gains) / n.sqrt();
        let over =
            |value: fn(&(f64, f64)) -> f64| mean(&pairs.iter().map(value).collect::<Vec<_>>());
        answers.push(EngineAnswer {
            engine,
            settings: pairs.len(),
            score: over(|pair| pair.0),
            own_score: over(|pair| pair.1),
            differs: mean(&gains) > doubt,
            parameters: by_name(&study.parameter_set(&own)),
        });
    }
    Ok(answers)
}

/// The point that is best for some settings: the lowest mean over its neighbours, weighted by a Gaussian whose width is Scott's
/// (1992, section 6.3) for runs spread evenly over the range.
fn own_best(study: &Study, scores: &Scores, numbers: &[usize]) -> Option<Vec<f64>> {
    let (settings, grid) = (study.settings(), &study.definition().grid);
    let runs: Vec<(Vec<f64>, f64)> = (scores.runs.iter())
        .filter(|run| {
            numbers
                .iter()
                .any(|n| settings.of_trial(run.index) == Setting::new(*n))
        })
        .filter_map(|run| Some((grid.place_of(&run.values), run.score?)))
        .collect();
    let axes = grid.ranges().len() as f64;
    let width = libm::pow(runs.len() as f64, -1.0 / (axes + 4.0)) / 12.0_f64.sqrt();
    let smoothed = |values: &[f64]| {
        let at = grid.place_of(values);
        let (mut weights, mut sum) = (0.0, 0.0);
        for (place, score) in &runs {
            let squares: f64 = (place.iter().zip(&at)).map(|(a, b)| (a - b).powi(2)).sum();
            let weight = libm::exp(-0.5 * squares / (width * width));
            weights += weight;
            sum += weight * score;
        }
        sum / weights
    };
    let visited = scores.points.iter().filter(|point| point.score.is_some());
    let known = visited.map(|point| (smoothed(&point.values), &point.values));
    let best = known
        .filter(|(score, _)| score.is_finite())
        .min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, values)| values.clone())
}

/// Scores at a point with these settings, known ones or simulated now; `None` where one diverged.
fn scores_with(
    study: &Study,
    scores: &Scores,
    values: &[f64],
    numbers: &[usize],
) -> Result<Vec<Option<f64>>> {
    let settings = study.settings();
    let known = |number: &usize| {
        let mut runs = scores.runs.iter().filter(|run| run.values == values);
        runs.find(|run| settings.of_trial(run.index) == Setting::new(*number))
    };
    let simulated = |number: &usize| -> Result<Option<f64>> {
        if let Some(run) = known(number) {
            return Ok(run.score);
        }
        // A trial's number says its setting.
        let trial = study.simulate_values(*number, values.to_vec())?;
        let scored = Scores::with_basis(study, &[trial], scores.basis.clone())?;
        Ok(scored.points[0].score)
    };
    numbers.par_iter().map(simulated).collect()
}
