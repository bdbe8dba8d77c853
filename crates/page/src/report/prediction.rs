//! The story of a prediction: what a robot will do before anybody builds it.

use std::path::Path;

use serde_json::Value;

use super::ensemble::{answer, behaviour_table, charts, distances, noise};
use super::page::html;
use super::section::{Section, pictures};
use super::story::Story;
use super::value::{at, first_text, float, list, measured, percent, span, text_of, titled};
use realgap_core::error::Result;

pub(super) fn prediction(folder: &Path, report: &Value) -> Result<Story> {
    let summary = at(report, "prediction");
    let success = at(report, "success");
    let range = at(success, "range");
    let mut sure = String::new();
    if !success.is_null() {
        let models = at(range, "models");
        sure = format!(
            " It gets at least {} far with a probability of {} ({} to {} by sampling alone{}).",
            measured(float(success, "least_displacement_m"), "m"),
            percent(float(at(success, "probability"), "share")),
            percent(float(at(success, "probability"), "low")),
            percent(float(at(success, "probability"), "high")),
            if models.is_null() {
                String::new()
            } else {
                format!(
                    "; {} to {} over other models, {} to {} with another engine",
                    percent(float(models, "low")),
                    percent(float(models, "high")),
                    percent(float(at(range, "other_engine"), "low")),
                    percent(float(at(range, "other_engine"), "high"))
                )
            }
        );
    }
    let case = serde_json::json!([{ "case": text_of(report, "robot"), "summary": summary }]);
    let cases = case.as_array().map_or(&[][..], Vec::as_slice);
    let not: Vec<&str> = list(report, "not_covered")
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let not = if not.is_empty() {
        String::new()
    } else {
        format!("<p>No number here knows of {}.</p>", html(&not.join("; ")))
    };
    Ok(Story {
        kind: "prediction",
        name: first_text(report, &["robot"])
            .unwrap_or("prediction")
            .to_owned(),
        answer: answer(summary, &sure),
        sections: vec![
            Section::new(
                "behaviours",
                "What it does, and how likely",
                behaviour_table(summary, cases),
            ),
            Section::new("motion", "Where it will be", charts("", summary)),
            Section::new("distance", "How far", distances(cases)),
            Section::new(
                "model",
                "What the model itself may be wrong by",
                model(at(report, "model")) + &not,
            ),
            Section::new("noise", "What repeats differ by", noise(summary)),
            pictures(folder, "pictures", "All repeats", |_| true)?,
        ],
        said: vec!["prediction", "model", "success", "robot"],
        ..Story::default()
    })
}

fn model(model: &Value) -> String {
    let models = list(model, "models");
    if models.is_empty() {
        return String::new();
    }
    let rows = models.iter().map(|one| {
        vec![
            text_of(one, "name").to_owned(),
            text_of(one, "source").to_owned(),
            percent(float(one, "ratio").map(|ratio| ratio - 1.0)),
        ]
    });
    let further = at(model, "further_run_m");
    format!(
        "{}<p class=\"note\">A further run, another engine included, goes {} with 90 %.</p>",
        titled("other model | from | changes the displacement by", rows),
        span(float(further, "low"), float(further, "high"), "m")
    )
}
