//! `best.ron`: the best values, readable wherever `--parameters` is.

use std::path::Path;

use super::kind::file;
use realgap_core::error::Result;
use realgap_core::file::{write_atomic, write_ron};
use realgap_core::unit::counted;
use realgap_lab::calibration::{Answer, Best, BestFile, Report, Study, recording_id};
use realgap_lab::claim::{About, Claim};

pub(super) fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let report = &answer.report;
    let Some(best) = &report.best else {
        return Ok(());
    };
    // The study's fixed values belong to the answer: the best of the rest holds only with them.
    let fixed = study
        .definition()
        .set
        .iter()
        .map(|a| (a.parameter.name.to_owned(), a.value));
    let file = BestFile {
        study: None,
        description: description(report, best, answer.scores.points.len()),
        parameters: fixed.chain(best.parameters.clone()).collect(),
        fitted_on: (study.definition().recordings.iter().enumerate())
            .filter(|(index, _)| !study.is_held_out(*index))
            .map(|(_, recording)| recording_id(recording))
            .collect(),
    };
    write_atomic(folder.join(file::BEST), write_ron(&file)?.as_bytes())
}

/// What the values are, the best of so many points, with what is claimed of the model and of each parameter.
pub(crate) fn description(report: &Report, best: &Best, points: usize) -> String {
    let is_said = |claim: &&Claim| matches!(claim.about, About::Model | About::Parameter);
    let said = report.claims.iter().filter(is_said);
    let said: Vec<&str> = said.map(|claim| claim.text.as_str()).collect();
    format!(
        "Best of {} of the study {} ({}, {} = {} {}). {}.",
        counted(points, "point"),
        report.study,
        counted(report.recordings, "recording"),
        report.metric,
        best.score,
        report.unit.label(),
        said.join(". "),
    )
}
