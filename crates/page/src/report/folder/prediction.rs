//! The story of a prediction: what a robot will do before anybody builds it.

use std::path::Path;

use serde::Deserialize;

use crate::report::document::page::html;
use crate::report::document::section::{Section, pictures};
use crate::report::document::value::*;
use crate::report::folder::claim::sentences;
use crate::report::folder::ensemble::{Case, Summary, behaviour_table, charts, distances, noise};
use crate::report::folder::story::Story;
use realgap_core::error::Result;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::{ModelError, Range};

/// What a page shows of a prediction card.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Predicted {
    robot: Option<String>,
    pub(in crate::report) claims: Vec<Claim>,
    prediction: Summary,
    model: Option<ModelError>,
    not_covered: Vec<String>,
}

pub(in crate::report) fn prediction(folder: &Path, report: &Predicted) -> Result<Story> {
    let summary = &report.prediction;
    let cases = [Case {
        case: report.robot.clone().unwrap_or_default(),
        summary: summary.clone(),
    }];
    let not = match html(&report.not_covered.join("; ")).as_str() {
        "" => String::new(),
        not => format!("<p>No number here knows of {not}.</p>"),
    };
    let does = behaviour_table(&cases);
    let wrong = report.model.as_ref().map_or_else(String::new, model) + &not;
    Ok(Story {
        kind: "prediction",
        name: report.robot.clone().unwrap_or("prediction".to_owned()),
        answer: sentences(&report.claims, &[About::Reach, About::Success]),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", charts("", summary)),
            Section::new("distance", "How far", distances(&cases)),
            Section::new("model", "What the model itself may be wrong by", wrong),
            Section::new("noise", "What repeats differ by", noise(&summary.noise)),
            pictures(folder, "pictures", "All repeats", |_| true)?,
        ],
        said: "prediction model success robot",
        ..Story::default()
    })
}

fn model(model: &ModelError) -> String {
    if model.models.is_empty() {
        return String::new();
    }
    let rows = model.models.iter().map(|one| {
        let changes = percent(one.ratio.map(|ratio| ratio - 1.0));
        vec![one.name.clone(), one.source.label().to_owned(), changes]
    });
    let rows = titled("other model | from | changes the displacement by", rows);
    let (Some(further), more) = (model.further_run_m, model.other_engine_adds_m) else {
        return rows;
    };
    let span = |range: Range| span(range.low, range.high, "m");
    format!(
        "{rows}<p class=\"note\">In an engine that was not asked, a run goes {} with 90 %: {} more than here (below 0: less).</p>",
        span(further),
        more.map_or_else(|| NOTHING.to_owned(), span)
    )
}
