//! `points.csv` and `scores.csv`: the same bytes for the same study, however it was run.

use std::path::Path;

use super::kind::file;
use realgap_core::error::{Error, Result};
use realgap_core::file::write_atomic;
use realgap_core::text::cell;
use realgap_lab::calibration::{Answer, PointScore, Study};

/// One row a point: parameters as columns, then score, unit, status and displacement error.
pub(super) fn write_points(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let header: Vec<&str> = ["score", "unit", "status", "displacement_error_m"].to_vec();
    let header = [names(study), header, vec!["indistinguishable", "runs"]].concat();
    let is_in = |position: usize| {
        let uncertainty = answer.uncertainty.as_ref();
        uncertainty.is_some_and(|u| u.indistinguishable[position])
    };
    let points = answer.scores.points.iter().enumerate();
    let rows = points.map(|(position, point)| {
        let mut row: Vec<String> = point.values.iter().map(f64::to_string).collect();
        row.push(number(point.score));
        row.push(answer.scores.unit.label().to_owned());
        row.push(status(point).to_owned());
        row.push(number(point.displacement_error_m));
        row.push(is_in(position).to_string());
        row.push(point.runs.to_string());
        row
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
    let fixed: Vec<_> = study
        .definition()
        .set
        .iter()
        .filter(|a| {
            !varied.contains(&a.parameter.name) && !a.parameter.name.starts_with("recording.")
        })
        .collect();
    let header: Vec<&str> = varied
        .iter()
        .copied()
        .chain(fixed.iter().map(|a| a.parameter.name))
        .collect();
    let every = draws.rows().len().div_ceil(DRAWN);
    let rows = draws.rows().iter().step_by(every).map(|values| {
        let all = values.iter().copied().chain(fixed.iter().map(|a| a.value));
        all.map(|value| value.to_string()).collect()
    });
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
        recordings
            .iter()
            .zip(&point.recordings)
            .map(|(recording, score)| {
                let mut row: Vec<String> = point.values.iter().map(f64::to_string).collect();
                row.push(recording.name.clone());
                row.push(score.to_string());
                row.push(answer.scores.unit.label().to_owned());
                row
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

fn status(point: &PointScore) -> &'static str {
    if point.diverged.is_some() {
        "diverged"
    } else {
        "ok"
    }
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
    let fail = |e: csv::Error| Error::invalid(format!("cannot write the table: {e}")).at_file(path);
    writer.write_record(header).map_err(fail)?;
    for row in rows {
        let cells = row.iter().map(|text| cell(text).into_owned());
        writer.write_record(cells).map_err(fail)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|e| Error::invalid(format!("cannot write the table: {e}")).at_file(path))?;
    write_atomic(path, &bytes)
}
