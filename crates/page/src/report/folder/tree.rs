//! A report as names and values: what a page can show of every report, whatever its type.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize as _, Serialize};
use serde_json::Value;

use crate::report::document::page::html;
use crate::report::document::value::{folded, shown, table};
use realgap_core::error::{Error, Result};
use realgap_core::file::versioned_value;
use realgap_core::unit::number;
use realgap_lab::claim::Claim;

/// The largest number of rows of a table; the report itself has all of them.
const MOST_ROWS: usize = 200;
/// The depth to which warnings of parts are collected; deeper ones belong to something else.
const DEEPEST: usize = 4;

/// A report as names and values.
#[derive(Debug)]
pub struct ReportTree(Value);

/// A JSON file; `whose` is for the message, e.g. `a report`.
///
/// # Errors
/// A file that cannot be read, or holds something else.
pub(in crate::report) fn read_json<T: DeserializeOwned>(path: &Path, whose: &str) -> Result<T> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read the file", path, &e))?;
    serde_json::from_str(&text)
        .map_err(|e| Error::invalid(format!("not {whose}: {e}")).at_file(path))
}

impl ReportTree {
    /// The findings of a command.
    ///
    /// # Errors
    /// What cannot be written as JSON.
    pub fn of(answer: &impl Serialize) -> Result<Self> {
        serde_json::to_value(answer)
            .map(Self)
            .map_err(|e| Error::invalid(format!("cannot write JSON: {e}")))
    }

    /// A report as a reader of its file gets it.
    ///
    /// # Errors
    /// What cannot be written as JSON.
    pub(in crate::report) fn of_report(report: &impl Serialize) -> Result<Self> {
        versioned_value(report).map(Self)
    }

    /// The report in a file.
    pub(in crate::report) fn read(path: &Path) -> Result<Self> {
        read_json(path, "a report").map(Self)
    }

    /// Whether something stands under this name.
    pub(in crate::report) fn has(&self, name: &str) -> bool {
        self.0.get(name).is_some()
    }

    /// The report as the type that a page needs; `path` is for the message.
    pub(in crate::report) fn typed<T: DeserializeOwned>(&self, path: &Path) -> Result<T> {
        T::deserialize(&self.0)
            .map_err(|e| Error::invalid(format!("not a report: {e}")).at_file(path))
    }

    /// The claims of the report; none where it makes none.
    pub(in crate::report) fn claims(&self) -> Vec<Claim> {
        let claims = self.0.get("claims").map(Vec::<Claim>::deserialize);
        claims.and_then(std::result::Result::ok).unwrap_or_default()
    }

    /// A number or a text of the report, by its name.
    pub(in crate::report) fn scalar(&self, name: &str) -> Option<String> {
        self.0.get(name).and_then(scalar)
    }

    /// Codes and messages of the warnings of a report and of what it holds, each once.
    pub(in crate::report) fn warnings(&self) -> Vec<(String, String)> {
        let mut all = Vec::new();
        collect(&self.0, 0, &mut all);
        all
    }

    /// Numbers and short texts directly in a report or one level below, without the names in `shown_elsewhere`.
    pub(in crate::report) fn scalars(&self, shown_elsewhere: &[&str]) -> Vec<(String, String)> {
        let mut all = Vec::new();
        for (name, value) in fields(&self.0) {
            if shown_elsewhere.contains(&name.as_str()) {
                continue;
            }
            let shown = name.replace('_', " ");
            if let Some(text) = scalar(value) {
                all.push((shown.clone(), text));
            }
            for (inner, value) in fields(value) {
                if let Some(text) = scalar(value) {
                    all.push((format!("{shown}: {}", inner.replace('_', " ")), text));
                }
            }
        }
        all
    }

    /// Versions, settings and hashes.
    pub(in crate::report) fn provenance(&self) -> Vec<(String, String)> {
        let origins = fields(self.0.get("provenance").unwrap_or(&Value::Null));
        let text = |value: &Value| scalar(value).unwrap_or_else(|| value.to_string());
        let pairs = origins.map(|(name, value)| (name.clone(), text(value)));
        pairs.collect()
    }

    /// Every list of the report whose items have fields, as a table of the fields that are numbers or texts. Warnings and claims stand
    /// elsewhere on the page.
    pub(in crate::report) fn tables(&self) -> String {
        let mut all = String::new();
        let is_elsewhere = |name: &str| name == "warnings" || name == "claims";
        for (name, value) in fields(&self.0).filter(|(name, _)| !is_elsewhere(name)) {
            let items = items(value);
            let first = fields(items.first().unwrap_or(&Value::Null));
            let columns = first.filter(|(_, value)| scalar(value).is_some());
            let columns: Vec<&str> = columns.map(|(name, _)| name.as_str()).collect();
            if columns.is_empty() {
                continue;
            }
            let head: Vec<String> = columns.iter().map(|name| name.replace('_', " ")).collect();
            let head: Vec<&str> = head.iter().map(String::as_str).collect();
            let rows = items.iter().take(MOST_ROWS).map(|item| {
                let cells = columns.iter().map(|name| item.get(name).and_then(scalar));
                cells.map(shown).collect()
            });
            let title = html(&name.replace('_', " "));
            let title = match items.len() {
                few if few <= MOST_ROWS => title,
                many => format!("{title} (the first {MOST_ROWS} of {many})"),
            };
            all += &folded(&title, &table(&head, rows));
        }
        all
    }
}

fn fields(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

fn items(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// A number or a text for readers; `None` for a list, an object or null.
fn scalar(value: &Value) -> Option<String> {
    match value {
        Value::Number(n) if n.is_f64() => n.as_f64().map(number),
        Value::Number(n) => Some(n.to_string()),
        Value::String(text) => Some(text.clone()),
        Value::Bool(yes) => Some(if *yes { "yes" } else { "no" }.to_owned()),
        _ => None,
    }
}

fn collect(value: &Value, depth: usize, all: &mut Vec<(String, String)>) {
    if depth > DEEPEST {
        return;
    }
    for warning in value.get("warnings").map_or(&[][..], items) {
        let text = |name: &str| warning.get(name).and_then(scalar).unwrap_or_default();
        let pair = (text("code"), text("message"));
        if !all.contains(&pair) {
            all.push(pair);
        }
    }
    for (_, value) in fields(value) {
        collect(value, depth + 1, all);
    }
    for value in items(value) {
        collect(value, depth + 1, all);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_of_any_part_is_collected_once() {
        let one = serde_json::json!({ "code": "few-recordings", "message": "<2>" });
        let report = serde_json::json!({ "warnings": [one], "cases": [{ "warnings": [one] }] });
        let all = ReportTree(report).warnings();
        assert_eq!(all, [("few-recordings".to_owned(), "<2>".to_owned())]);
    }
}
