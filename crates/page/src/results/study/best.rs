//! `best.ron`: the best values, as every command with the option `--parameters` reads them.

use std::collections::BTreeMap;
use std::path::Path;

use crate::results::kind::file;
use realgap_core::error::Result;
use realgap_core::file::{write_atomic, write_ron};
use realgap_core::unit::counted;
use realgap_lab::calibration::{Answer, Best, BestFile, Report, Study, recording_id};
use realgap_lab::claim::About;
use realgap_simulation::parameter::{Assignment, ParameterSet};

pub(in crate::results) fn write(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    let report = &answer.report;
    let Some(best) = &report.best else {
        return Ok(());
    };
    // The study's fixed values belong to the answer: the best values of the other parameters hold only together with them.
    let fixed = study.definition().set.iter();
    let fixed = fixed.map(|a| (a.parameter.name.to_owned(), a.value));
    let file = BestFile {
        study: None,
        description: description(report, best, answer.scores.points.len()),
        parameters: fixed.chain(best.parameters.clone()).collect(),
        draws: columns(&draws(study, answer)),
        fitted_on: (study.definition().recordings.iter().enumerate())
            .filter(|(index, _)| !study.is_held_out(*index))
            .map(|(_, recording)| recording_id(recording))
            .collect(),
    };
    write_atomic(folder.join(file::BEST), write_ron(&file)?.as_bytes())
}

/// A description of the values: the best of so many points, with the claims about the model and about each parameter.
pub(crate) fn description(report: &Report, best: &Best, points: usize) -> String {
    let about = [
        About::Model,
        About::Engines,
        About::Parameter,
        About::Difference,
    ];
    let said = report.claims.iter().filter(|c| about.contains(&c.about));
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

/// The number of draws in a file of values: so many that a single draw has little influence.
const DRAWN: usize = 64;

/// Draws from the posterior: one set of values a draw, without the parameters that describe the recordings.
pub fn draws(study: &Study, answer: &Answer) -> Vec<Vec<ParameterSet>> {
    let parameters = &study.definition().parameters;
    let rows = answer.draws.iter().flat_map(|draws| {
        let every = draws.rows().len().div_ceil(DRAWN);
        draws.rows().iter().step_by(every)
    });
    let set = |row: &Vec<f64>| -> ParameterSet {
        let values = parameters.iter().zip(row);
        let simulated = values.filter(|(parameter, _)| !parameter.name.starts_with("recording."));
        let drawn = simulated.map(|(parameter, value)| (parameter, rounded(*value)));
        let drawn = drawn.map(|(parameter, value)| Assignment { parameter, value });
        drawn.collect()
    };
    vec![rows.map(set).collect()]
}

/// The same as columns.
fn columns(groups: &[Vec<ParameterSet>]) -> BTreeMap<String, Vec<f64>> {
    let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for drawn in groups.iter().flatten().flat_map(ParameterSet::iter) {
        let column = columns.entry(drawn.parameter.name.to_owned()).or_default();
        column.push(drawn.value);
    }
    columns
}

/// A value with six significant digits, which is more than any reader needs.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
