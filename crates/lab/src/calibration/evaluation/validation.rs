//! Validation: scores on recordings that were held out of the fit.

use serde::{Deserialize, Serialize};

use crate::calibration::evaluation::band::Bands;
use crate::calibration::study::split::fold;
use crate::calibration::{PointScore, Scores, Split, Study};
use realgap_core::statistics::{least_by, mean, mean_of, standard_deviation};
use realgap_core::{Code, Result, Warning};

/// How the best point scores on recordings that were held out of the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validation {
    /// How the recordings were split.
    pub split: String,
    /// Mean score of the recordings that were fitted, at the best point.
    pub fit_score: f64,
    /// Mean score of held-out recordings.
    pub held_out_score: f64,
    /// Standard error of `held_out_score − fit_score`.
    pub difference_standard_error: f64,
    /// Held-out recordings, each counted once.
    pub held_out_recordings: usize,
    /// One entry per fold; empty for a single hold-out.
    pub folds: Vec<Fold>,
    /// How many samples of what was held out lie in the bands of the predictions of least squares; `None` for other methods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bands: Option<Bands>,
}

/// One fold: fitted without some recordings, and checked with these.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fold {
    /// Best values of the study's parameters without the held-out recordings, in order.
    pub values: Vec<f64>,
    /// Mean score of the fitted recordings at those values.
    pub fit_score: f64,
    /// Mean score of the held-out recordings at those values.
    pub held_out_score: f64,
    /// Names of the held-out recordings.
    pub held_out: Vec<String>,
}

/// A warning is given where held-out and fitted score differ by more than so many standard errors.
const PARTED: f64 = 2.0;

impl Validation {
    /// `None` where nothing is held out or no point has a score. `refits` are the best points of fits without the recordings of
    /// each fold; where there are none, every point was evaluated, and the best one for the other recordings is taken.
    ///
    /// # Errors
    /// None beyond those of [`Split::held_out`].
    pub fn new(
        study: &Study,
        scores: &Scores,
        refits: Option<Vec<PointScore>>,
    ) -> Result<Option<Self>> {
        let (Some(split), Some(best)) = (study.definition().split, scores.best) else {
            return Ok(None);
        };
        let best = &scores.points[best];
        match split {
            Split::HoldOut(_) => Ok(Some(Self::hold_out(study, best, split))),
            Split::Folds(folds) => Ok(Self::folds(study, scores, best, folds, refits)),
        }
    }

    fn hold_out(study: &Study, best: &PointScore, split: Split) -> Self {
        let [fitted, held_out] =
            [false, true].map(|held_out| study.part_of(&best.recordings, held_out));
        let variance = |values: &[f64]| standard_deviation(values).powi(2) / values.len() as f64;
        Self {
            split: split.to_string(),
            fit_score: mean(&fitted),
            held_out_score: mean(&held_out),
            difference_standard_error: (variance(&fitted) + variance(&held_out)).sqrt(),
            held_out_recordings: held_out.len(),
            folds: Vec::new(),
            bands: None,
        }
    }

    fn folds(
        study: &Study,
        scores: &Scores,
        best: &PointScore,
        folds: usize,
        refits: Option<Vec<PointScore>>,
    ) -> Option<Self> {
        let definition = study.definition();
        let recordings = &definition.recordings;
        let mut differences = Vec::new();
        let mut rows = Vec::new();
        for number in 0..folds {
            let held_out = fold(recordings.len(), definition.seed, folds, number);
            let over = |point: &PointScore, keep: bool| {
                let all = point.recordings.iter().enumerate();
                let chosen = all.filter(|(recording, _)| held_out.contains(recording) != keep);
                mean_of(chosen.map(|(_, score)| *score))
            };
            let winner = match &refits {
                Some(refits) => refits.get(number)?,
                None => {
                    let scored = scores.points.iter().filter(|point| point.score.is_some());
                    least_by(scored, |point| over(point, true))?
                }
            };
            let difference = |r: &usize| winner.recordings[*r] - best.recordings[*r];
            differences.extend(held_out.iter().map(difference));
            let names = held_out.iter().map(|r| recordings[*r].name.clone());
            rows.push(Fold {
                values: winner.values.clone(),
                fit_score: over(winner, true),
                held_out_score: over(winner, false),
                held_out: names.collect(),
            });
        }
        let fit_score = mean(&best.recordings);
        Some(Self {
            split: Split::Folds(folds).to_string(),
            fit_score,
            held_out_score: fit_score + mean(&differences),
            difference_standard_error: standard_deviation(&differences)
                / (differences.len() as f64).sqrt(),
            held_out_recordings: differences.len(),
            folds: rows,
            bands: None,
        })
    }

    /// A warning where the best point scores clearly worse on held-out recordings.
    pub fn warning(&self) -> Option<Warning> {
        let difference = self.held_out_score - self.fit_score;
        (difference > PARTED * self.difference_standard_error && difference > 0.0).then(|| {
            Code::Overfitted.warning(format!(
                "the score on recordings not fitted is {:.3} times that on the fitted ones, more than chance explains: \
                     the fit does not carry over",
                self.held_out_score / self.fit_score
            ))
        })
    }
}
