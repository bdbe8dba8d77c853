//! The page of a prediction: what a robot will do before it is built.

use serde::Deserialize;

use super::content::PageContent;
use super::ensemble::{Case, ForecastSummary, behaviour_table, charts, distances, noise};
use crate::report::document::page::html;
use crate::report::document::picture::Pictures;
use crate::report::document::section::Section;
use crate::report::document::value::*;
use realgap_lab::claim::Claim;
use realgap_lab::prediction::{ModelError, OpinionSource, Range};

/// What a page shows of a prediction card.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct PredictionSummary {
    robot: Option<String>,
    pub(in crate::report) claims: Vec<Claim>,
    prediction: ForecastSummary,
    model: Option<ModelError>,
    not_covered: Vec<String>,
}

pub(super) fn content(report: &PredictionSummary, pictures: &Pictures) -> PageContent {
    let summary = &report.prediction;
    let cases = [Case {
        case: report.robot.clone().unwrap_or_default(),
        summary: summary.clone(),
    }];
    let not = match html(&report.not_covered.join("; ")).as_str() {
        "" => String::new(),
        not => format!("<p>These numbers do not cover {not}.</p>"),
    };
    let does = behaviour_table(&cases);
    let wrong = report.model.as_ref().map_or_else(String::new, model) + &not;
    PageContent {
        kind: "prediction",
        name: report.robot.clone().unwrap_or("prediction".to_owned()),
        claims: report.claims.clone(),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", charts("", summary)),
            Section::new("distance", "How far", distances(&cases)),
            Section::new("model", "The error of the model itself", wrong),
            Section::new("noise", "How repeats differ", noise(&summary.noise)),
            pictures.section("pictures", "All repeats", |_| true),
        ],
        shown_fields: "prediction model success robot",
        ..PageContent::default()
    }
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
    let said = model.third_opinion.as_ref().map(OpinionSource::to_string);
    format!(
        "{rows}<p class=\"note\">In a further simulator, which none of these numbers used, a run goes {} with 90 %{}. That is {} more than here; a negative number means less.</p>",
        span(further),
        said.map_or_else(String::new, |said| format!(" ({})", html(&said))),
        more.map_or_else(|| NOTHING.to_owned(), span)
    )
}
