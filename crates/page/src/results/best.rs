//! `best.ron`: the best values, readable wherever `--parameters` is.

use std::path::Path;

use super::kind::file;
use realgap_core::error::Result;
use realgap_core::file::{write_atomic, write_ron};
use realgap_core::unit::counted;
use realgap_lab::calibration::{Answer, BestFile, Study, recording_id};

pub(super) fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let report = &answer.report;
    let Some(best) = &report.best else {
        return Ok(());
    };
    let verdicts: Vec<&str> = report
        .verdicts
        .iter()
        .map(|verdict| verdict.text.as_str())
        .collect();
    // The study's fixed values belong to the answer: the best of the rest holds only with them.
    let fixed = study
        .definition()
        .set
        .iter()
        .map(|a| (a.parameter.name.to_owned(), a.value));
    let file = BestFile {
        study: None,
        description: format!(
            "Best of {} of the study {} ({}, {} = {} {}). {}.",
            counted(answer.scores.points.len(), "point"),
            report.study,
            counted(report.recordings, "recording"),
            report.metric,
            best.score,
            report.unit.label(),
            verdicts.join(". "),
        ),
        parameters: fixed.chain(best.parameters.clone()).collect(),
        fitted_on: (study.definition().recordings.iter().enumerate())
            .filter(|(index, _)| !study.is_held_out(*index))
            .map(|(_, recording)| recording_id(recording))
            .collect(),
    };
    write_atomic(folder.join(file::BEST), write_ron(&file)?.as_bytes())
}
