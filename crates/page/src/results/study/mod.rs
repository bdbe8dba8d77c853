//! What a sweep or a tuning leaves in a folder: tables, pictures, the report, the best values.

pub(crate) mod best;
mod cell;
pub(crate) mod chart;
mod corner;
pub(crate) mod data;
mod fitted;
mod interval;
pub(crate) mod joint;
mod picture;
mod plane;
mod table;

use std::path::Path;

use super::draft::{Draft, publish};
use super::ensemble::write_report;
use super::kind::{Kind, file};
use crate::report::ResultsPage;
use data::{StudyData, StudyTables};
use realgap_core::error::{Error, Result};
use realgap_lab::calibration::{Answer, Method, Study};

pub use best::draws;
pub use data::{RankedPoints, ranked_points};
pub use fitted::FittedStudy;
pub use joint::{JointSample, joint_samples};

/// Writes what an answer holds into `folder`, next to the store where there is one: tables, pictures, the report, the best
/// values. They take the place of older results once all of them are written. Returned is what the page of the folder shows.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<ResultsPage> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::io("make the results folder", folder, &e))?;
    let tables = StudyTables::new(study, answer)?;
    let data = StudyData::of(answer, &tables)?;
    publish(folder, Kind::Study, |draft| {
        write_tables(draft, study, answer, &tables)?;
        write_report(draft.folder(), file::SUMMARY, &answer.report)?;
        best::write(draft.folder(), study, answer)?;
        plane::write_basis(draft.folder(), answer)?;
        picture::draw(draft, study, answer, &data)?;
        let pictures = draft.take_pictures();
        ResultsPage::of_study(&answer.report, data, pictures)
    })
}

fn write_tables(draft: &Draft, study: &Study, answer: &Answer, tables: &StudyTables) -> Result<()> {
    draft.table(file::POINTS, &tables.points)?;
    if let Some(drawn) = table::indistinguishable(study, answer) {
        draft.table(file::INDISTINGUISHABLE, &drawn)?;
    }
    if let Some(scores) = table::scores(study, answer) {
        draft.table(file::SCORES, &scores)?;
    }
    draft.table(file::PROFILES, &tables.profiles)?;
    if let Method::Tune(_) = answer.method {
        draft.table(file::TRIALS, &tables.trials)?;
    }
    match tables.joints.rows() {
        [] => Ok(()),
        _ => draft.table(file::JOINTS, &tables.joints),
    }
}
