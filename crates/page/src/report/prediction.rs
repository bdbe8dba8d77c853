//! The story of a prediction: what a robot will do before anybody builds it.

use std::path::Path;

use serde_json::Value;

use super::claim::sentences;
use super::ensemble::{behaviour_table, charts, distances, noise};
use super::page::html;
use super::section::{Section, pictures};
use super::story::Story;
use super::value::*;
use realgap_core::error::Result;

pub(super) fn prediction(folder: &Path, report: &Value) -> Result<Story> {
    let summary = report.at("prediction");
    let case = serde_json::json!([{ "case": report.text("robot"), "summary": summary }]);
    let cases = case.as_array().map_or(&[][..], Vec::as_slice);
    let not = report.list("not_covered").iter();
    let not = not.filter_map(Value::as_str).collect::<Vec<_>>().join("; ");
    let not = match html(&not).as_str() {
        "" => String::new(),
        not => format!("<p>No number here knows of {not}.</p>"),
    };
    let does = behaviour_table(summary, cases);
    let wrong = model(report.at("model")) + &not;
    Ok(Story {
        kind: "prediction",
        name: report.named("robot", "prediction"),
        answer: sentences(report, &["reach", "success"]),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", charts("", summary)),
            Section::new("distance", "How far", distances(cases)),
            Section::new("model", "What the model itself may be wrong by", wrong),
            Section::new("noise", "What repeats differ by", noise(summary)),
            pictures(folder, "pictures", "All repeats", |_| true)?,
        ],
        said: vec!["prediction", "model", "success", "robot"],
        ..Story::default()
    })
}

fn model(model: &Value) -> String {
    let models = model.list("models");
    if models.is_empty() {
        return String::new();
    }
    let rows = models.iter().map(|one| {
        vec![
            one.owned("name"),
            one.owned("source"),
            percent(one.float("ratio").map(|ratio| ratio - 1.0)),
        ]
    });
    let rows = titled("other model | from | changes the displacement by", rows);
    let further = model.at("further_run_m");
    if further.is_null() {
        return rows;
    }
    format!(
        "{rows}<p class=\"note\">In an engine that was not asked, a run goes {} with 90 %: {} more than here (below 0: less).</p>",
        further.span(["low", "high"], "m"),
        model.at("other_engine_adds_m").span(["low", "high"], "m")
    )
}
