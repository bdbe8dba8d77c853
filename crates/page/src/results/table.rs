//! `points.csv` and `scores.csv`: the same bytes for the same study, however it was run.

use std::path::Path;

use super::kind::file;
use super::study::cell::is_alike;
use realgap_core::error::{Error, Result};
use realgap_core::file::write_atomic;
use realgap_core::text::cell;
use realgap_lab::calibration::{Answer, Study};

/// One row a point: parameters as columns, then score, unit, status and displacement error.
pub(super) fn write_points(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let header: Vec<&str> = ["score", "unit", "status", "displacement_error_m"].to_vec();
    let header = [names(study), header, vec!["indistinguishable", "runs"]].concat();
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
        ];
        [texts(&point.values), found].concat()
    });
    write(&folder.join(file::POINTS), &header, rows)
}

/// Rows of `indistinguishable.csv`.
const DRAWN: usize = 200;

/// Parameter values as likely as the recordings leave them, one row a draw, with the study's fixed values.
pub(super) fn write_indistinguishable(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let Some(draws) = &answer.draws else {
        return Ok(());
    };
    let varied = names(study);
    let is_fixed = |name: &str| !varied.contains(&name) && !name.starts_with("recording.");
    let fixed = study.definition().set.iter();
    let fixed = fixed.filter(|a| is_fixed(a.parameter.name));
    let (more, fixed): (Vec<&str>, Vec<f64>) = fixed.map(|a| (a.parameter.name, a.value)).unzip();
    let header = [&varied[..], &more].concat();
    let every = draws.rows().len().div_ceil(DRAWN);
    let rows = draws.rows().iter().step_by(every);
    let rows = rows.map(|values| [texts(values), texts(&fixed)].concat());
    write(&folder.join(file::INDISTINGUISHABLE), &header, rows)
}

/// One row a point and recording, where there are several recordings.
pub(super) fn write_scores(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let recordings = &study.definition().recordings;
    if recordings.len() < 2 {
        return Ok(());
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
    write(&folder.join(file::SCORES), &header, rows)
}

/// One row a parameter and value: the lowest score that is to be expected there, and the range that holds it with 90 %.
pub(super) fn write_profiles(folder: &Path, answer: &Answer) -> Result<()> {
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
    write(&folder.join(file::PROFILES), &header, rows)
}

/// Names of the parameters that are varied.
pub(super) fn names(study: &Study) -> Vec<&'static str> {
    let ranges = study.definition().grid.ranges().iter();
    ranges.map(|range| range.parameter.name).collect()
}

/// Each as [`number`].
pub(super) fn texts(values: &[f64]) -> Vec<String> {
    values.iter().map(f64::to_string).collect()
}

/// Shortest text that reads back to the same bits; empty where there is no number.
pub(super) fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

pub(super) fn write(
    path: &Path,
    header: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
) -> Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let fail = |e: &dyn std::fmt::Display| {
        Error::invalid(format!("cannot write the table: {e}")).at_file(path)
    };
    writer.write_record(header).map_err(|e| fail(&e))?;
    for row in rows {
        let cells = row.iter().map(|text| cell(text).into_owned());
        writer.write_record(cells).map_err(|e| fail(&e))?;
    }
    write_atomic(path, &writer.into_inner().map_err(|e| fail(&e))?)
}
