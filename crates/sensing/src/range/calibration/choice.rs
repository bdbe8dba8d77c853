//! Chooses the forms of mean and standard deviation by cross-validation over distances.

use rayon::prelude::*;
use serde::Serialize;

use super::cell::Summary;
use super::fit::{Plan, fit};
use crate::range::form::Form;

/// A pair of forms and its score in the cross-validation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Form of the mean.
    pub mean: &'static str,
    /// Form of the standard deviation.
    pub spread: &'static str,
    /// Number of parameters.
    pub parameters: usize,
    /// Mean logarithm of the density of a reading at a distance that was left out of the fit; higher is better. `None` if the
    /// forms cannot be fitted.
    pub log_score: Option<f64>,
    /// Score of the best candidate minus the score of this candidate.
    pub behind: Option<f64>,
    /// Standard error of that difference, over the distances.
    pub behind_error: Option<f64>,
    /// Whether this pair was chosen.
    pub is_chosen: bool,
}

/// Largest number of groups in which distances are left out.
const MOST_FOLDS: usize = 20;
/// Lower limit of the log density of a held-out reading, for readings that are impossible according to a fit.
const WORST: f64 = -1e3;

/// The groups of held-out cells. Neighbouring distances are in different groups. The first and the last distance are never left out,
/// because a form is to be tested by interpolation, not by extrapolation.
fn folds(data: &[Summary]) -> Vec<Vec<bool>> {
    let mut distances: Vec<f64> = data.iter().map(|s| s.distance).collect();
    distances.dedup();
    let inner = &distances[1..distances.len() - 1];
    let count = inner.len().min(MOST_FOLDS);
    (0..count)
        .map(|fold| {
            let held = |s: &Summary| {
                inner
                    .iter()
                    .position(|d| *d == s.distance)
                    .is_some_and(|i| i % count == fold)
            };
            data.iter().map(held).collect()
        })
        .collect()
}

/// Scores every plan and chooses one. Among the plans whose score is within one standard error of the best score (Hastie, Tibshirani &
/// Friedman 2009, section 7.10), the one with the fewest parameters is chosen; among these, the one with the best score.
///
/// `data` are in order of distance, with at least three different distances.
pub(super) fn choose(plans: &[Plan], data: &[Summary]) -> (Vec<Candidate>, Option<usize>) {
    let folds = folds(data);
    let scores: Vec<Option<Vec<f64>>> = plans
        .par_iter()
        .map(|plan| {
            // A plan is refused if it cannot be fitted to all data.
            fit(*plan, data)?;
            let of_fold = |held: &Vec<bool>| {
                let part = |wanted: bool| -> Vec<Summary> {
                    data.iter()
                        .zip(held)
                        .filter(|(_, h)| **h == wanted)
                        .map(|(s, _)| *s)
                        .collect()
                };
                let (fitted, held) = (fit(*plan, &part(false))?, part(true));
                let count: f64 = held.iter().map(|s| s.count).sum();
                let sum: f64 = held
                    .iter()
                    .map(|s| fitted.log_likelihood(s).max(WORST * s.count))
                    .sum();
                Some(sum / count)
            };
            folds.iter().map(of_fold).collect()
        })
        .collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let best = (0..plans.len())
        .filter_map(|i| Some((i, mean(scores[i].as_ref()?))))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(i, _)| i);
    let behind = |i: usize| -> Option<(f64, f64)> {
        let (own, best) = (scores[i].as_ref()?, scores[best?].as_ref()?);
        let differences: Vec<f64> = best.iter().zip(own).map(|(b, o)| b - o).collect();
        let error = realgap_core::statistics::standard_deviation(&differences)
            / (differences.len() as f64).sqrt();
        Some((mean(&differences), error))
    };
    let parameters = |i: usize| -> usize {
        let mut distances: Vec<f64> = data.iter().map(|s| s.distance).collect();
        distances.dedup();
        let of = |form: &dyn Form| form.parameters(&form.knots(&distances)).len();
        of(plans[i].mean) + of(plans[i].spread)
    };
    let chosen = (0..plans.len())
        .filter_map(|i| {
            let (gap, error) = behind(i)?;
            (gap <= error).then_some((i, parameters(i), gap))
        })
        .min_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)))
        .map(|(i, ..)| i);
    let candidates = (0..plans.len())
        .map(|i| Candidate {
            mean: plans[i].mean.name(),
            spread: plans[i].spread.name(),
            parameters: parameters(i),
            log_score: scores[i].as_ref().map(|s| mean(s)),
            behind: behind(i).map(|(gap, _)| gap),
            behind_error: behind(i).map(|(_, error)| error),
            is_chosen: Some(i) == chosen,
        })
        .collect();
    (candidates, chosen)
}
