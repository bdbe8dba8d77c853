//! Tables of a sweep or a tuning: `points.csv`, `indistinguishable.csv`, `scores.csv`, `profiles.csv` and `trials.csv`.

use crate::results::study::cell::is_alike;
use crate::results::table::{CsvTable, number, texts};
use realgap_lab::calibration::{Answer, PointScore, Study, Tuned};

/// One row a point: parameters as columns, then the mean score over its runs, unit, status and displacement error, whether the point
/// belongs to the confidence set, its runs, the number of the setting of a single run, and the mean score over all equally valid
/// settings: that of the runs where the point was simulated with all of them, otherwise as all runs let expect, with the ends of its
/// 90 % interval.
pub(super) fn points(study: &Study, answer: &Answer) -> CsvTable {
    let header: Vec<&str> = ["score", "unit", "status", "displacement_error_m"].to_vec();
    let last = [
        "indistinguishable",
        "runs",
        "setting",
        "mean_score",
        "low",
        "high",
    ];
    let header = [names(study), header, last.to_vec()].concat();
    let settings = study.setting_count();
    let points = answer.scores.points.iter().enumerate();
    let rows = points.map(|(position, point)| {
        let status = if point.diverged.is_some() {
            "diverged"
        } else {
            "ok"
        };
        let found = vec![
            number(point.score),
            answer.scores.unit.label().to_owned(),
            status.to_owned(),
            number(point.displacement_error_m),
            is_alike(answer, position).to_string(),
            point.runs.to_string(),
            match point.runs {
                1 if settings > 1 => study.setting_of_trial(point.index).to_string(),
                _ => String::new(),
            },
        ];
        // Nothing is expected of a point whose simulation diverged.
        let expected = point.score.and(answer.expected_with_band(&point.values));
        let is_settled = point.runs >= settings;
        let (mean, ends) = match (expected, is_settled) {
            (Some((mean, ends)), false) => (Some(mean), Some(ends)),
            (Some((_, ends)), true) => (point.score, Some(ends)),
            (None, true) => (point.score, None),
            // What is not known stays empty: a single run is no mean.
            (None, false) => (None, None),
        };
        let ends = [ends.map(|(low, _)| low), ends.map(|(_, high)| high)];
        let found = [found, vec![number(mean)], ends.map(number).to_vec()].concat();
        [texts(&point.values), found].concat()
    });
    CsvTable::new(&header, rows)
}

/// Rows of `indistinguishable.csv`.
const DRAWN: usize = 200;

/// Draws from the posterior: parameter values, one row a draw, with the study's fixed values.
pub(super) fn indistinguishable(study: &Study, answer: &Answer) -> Option<CsvTable> {
    let draws = answer.draws.as_ref()?;
    let varied = names(study);
    let is_fixed = |name: &str| !varied.contains(&name) && !name.starts_with("recording.");
    let fixed = study.definition().set.iter();
    let fixed = fixed.filter(|a| is_fixed(a.parameter.name));
    let (more, fixed): (Vec<&str>, Vec<f64>) = fixed.map(|a| (a.parameter.name, a.value)).unzip();
    let header = [&varied[..], &more].concat();
    let every = draws.rows().len().div_ceil(DRAWN);
    let rows = draws.rows().iter().step_by(every);
    let rows = rows.map(|values| [texts(values), texts(&fixed)].concat());
    Some(CsvTable::new(&header, rows))
}

/// One row a point and recording, where there are several recordings.
pub(super) fn scores(study: &Study, answer: &Answer) -> Option<CsvTable> {
    let recordings = &study.definition().recordings;
    if recordings.len() < 2 {
        return None;
    }
    let header = [names(study), vec!["recording", "score", "unit"]].concat();
    let rows = answer.scores.points.iter().flat_map(|point| {
        let scored = recordings.iter().zip(&point.recordings);
        scored.map(|(recording, score)| {
            let unit = answer.scores.unit.label().to_owned();
            let found = vec![recording.name.clone(), score.to_string(), unit];
            [texts(&point.values), found].concat()
        })
    });
    Some(CsvTable::new(&header, rows))
}

/// One row a parameter and value: the lowest score that is to be expected there, and the range that holds it with 90 %.
pub(super) fn profiles(answer: &Answer) -> CsvTable {
    let header = ["parameter", "value", "lowest_score", "low", "high", "unit"];
    let header = [&header[..], &["indistinguishable"]].concat();
    let rows = answer.profiles.iter().flat_map(|profile| {
        profile.values.iter().enumerate().map(|(index, value)| {
            vec![
                profile.parameter.name.to_owned(),
                value.to_string(),
                profile.scores[index].to_string(),
                profile.bands[index].0.to_string(),
                profile.bands[index].1.to_string(),
                answer.scores.unit.label().to_owned(),
                profile.indistinguishable[index].to_string(),
            ]
        })
    });
    CsvTable::new(&header, rows)
}

/// One row a trial in the order of evaluation.
pub(super) fn trials(study: &Study, answer: &Answer, tuned: &Tuned) -> CsvTable {
    let header = ["trial", "phase"].into_iter().chain(names(study));
    let header: Vec<&str> = header.chain(["score", "unit", "best_so_far"]).collect();
    let points = asked_for(answer, tuned);
    let rows = points.iter().zip(best_so_far(points)).map(|(point, best)| {
        let is_design = point.index < tuned.design;
        let phase = if is_design { "design" } else { "search" };
        let first = vec![point.index.to_string(), phase.to_owned()];
        let unit = answer.scores.unit.label().to_owned();
        let last = vec![number(point.score), unit, number(best)];
        [first, texts(&point.values), last].concat()
    });
    CsvTable::new(&header, rows)
}

/// The runs that the optimizer asked for, without those that complete the settings of the best point.
pub(super) fn asked_for<'a>(answer: &'a Answer, tuned: &Tuned) -> &'a [PointScore] {
    let runs = &answer.scores.runs;
    &runs[..runs.len().min(tuned.evaluated)]
}

/// Best score after each point; `None` until one has a score.
fn best_so_far(points: &[PointScore]) -> Vec<Option<f64>> {
    let mut best: Option<f64> = None;
    let scores = points.iter().map(|point| point.score);
    let so_far = scores.map(|score| {
        best = best
            .zip(score)
            .map(|(best, score)| best.min(score))
            .or(best)
            .or(score);
        best
    });
    so_far.collect()
}

/// Names of the parameters that are varied.
fn names(study: &Study) -> Vec<&'static str> {
    let ranges = study.definition().grid.ranges().iter();
    ranges.map(|range| range.parameter.name).collect()
}
