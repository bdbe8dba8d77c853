//! What a report claims: its own words, which nothing here adds to.

use serde_json::Value;

use super::value::*;

fn claims<'a>(report: &'a Value, about: &'a str) -> impl Iterator<Item = &'a Value> {
    let claims = report.list("claims").iter();
    claims.filter(move |claim| claim.text("about") == about)
}

/// The sentences about these things, in this order, after each other.
pub(super) fn sentences(report: &Value, about: &[&str]) -> String {
    let of = |about: &&str| -> Vec<String> {
        let said = claims(report, about).map(|claim| claim.owned("text"));
        said.collect()
    };
    let ended = |text: String| {
        if text.ends_with('.') {
            text
        } else {
            text + "."
        }
    };
    let all: Vec<String> = about.iter().flat_map(of).map(ended).collect();
    all.join(" ")
}

/// What is said of a thing in the cell of a table, or a dash.
pub(super) fn word(report: &Value, about: &str, name: &str) -> String {
    let mut found = claims(report, about).filter(|claim| claim.text("name") == name);
    found
        .next()
        .map_or("–".to_owned(), |claim| claim.owned("word"))
}
