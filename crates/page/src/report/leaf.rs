//! The page of one report: what a command found, without a folder of its own.

use std::path::Path;

use serde_json::Value;

use super::page::html;
use super::section::{Section, beside, embedded, numbers, provenance, warnings};
use super::story::Story;
use super::value::*;
use realgap_core::error::Result;

/// Longer tables are in the report itself.
const MOST_ROWS: usize = 200;

/// What one command found.
#[derive(Debug)]
pub struct Leaf<'a> {
    /// What it is of: `sensor`, `radio`, …
    pub kind: &'static str,
    /// Of what, e.g. the log's name.
    pub name: &'a str,
    /// As the command prints it: its first line is the answer.
    pub text: &'a str,
    /// The same as data.
    pub report: &'a Value,
    /// Pictures that were drawn of it.
    pub pictures: &'a [&'a Path],
    /// The command.
    pub command: &'a str,
}

impl Leaf<'_> {
    /// The page: one HTML file.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn page(&self) -> Result<String> {
        let mut lines = self.text.trim().lines();
        let answer = lines
            .next()
            .unwrap_or("What was found is in the tables below.");
        let rest: Vec<&str> = lines.collect();
        let found = if rest.is_empty() {
            String::new()
        } else {
            format!(
                "<pre tabindex=\"0\">{}</pre>",
                rest.iter()
                    .map(|line| html(line))
                    .collect::<Vec<_>>()
                    .join("\n")
            )
        };
        let sections = vec![
            Section::new("found", "What was found", found),
            Section::new("pictures", "Pictures", self.figures()?),
            Section::new("tables", "Tables", tables(self.report)),
            warnings(self.report),
            numbers(self.report, &[]),
            provenance(self.report, Some(self.command), None),
        ];
        let story = Story {
            kind: self.kind,
            name: self.name.to_owned(),
            answer: answer.to_owned(),
            sections,
            ..Story::default()
        };
        Ok(story.page(None))
    }

    fn figures(&self) -> Result<String> {
        let mut all = String::new();
        for path in self.pictures {
            let kind = match path.extension().and_then(|ending| ending.to_str()) {
                Some("svg") => "image/svg+xml",
                _ => "image/png",
            };
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            all += &embedded(path, kind, &name)?;
        }
        Ok(beside(&all))
    }
}

/// Every list of the report whose items have fields, as a table of those that are numbers or texts.
fn tables(report: &Value) -> String {
    let mut all = String::new();
    for (name, value) in report.as_object().into_iter().flatten() {
        let items = value.as_array().map_or(&[][..], Vec::as_slice);
        let Some(first) = items
            .first()
            .and_then(Value::as_object)
            .filter(|_| name != "warnings")
        else {
            continue;
        };
        let fields: Vec<&String> = first
            .iter()
            .filter(|(_, value)| scalar(value).is_some())
            .map(|(name, _)| name)
            .collect();
        if fields.is_empty() {
            continue;
        }
        let head: Vec<String> = fields.iter().map(|field| field.replace('_', " ")).collect();
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        let rows = items.iter().take(MOST_ROWS).map(|item| {
            let cell = |field: &&String| item.get(field.as_str()).and_then(scalar);
            fields
                .iter()
                .map(|field| cell(field).unwrap_or_else(|| "–".to_owned()))
                .collect()
        });
        let title = html(&name.replace('_', " "));
        let more = match items.len() {
            few if few <= MOST_ROWS => String::new(),
            many => format!(" (the first {MOST_ROWS} of {many})"),
        };
        all += &format!(
            "<details><summary>{title}{more}</summary>{}</details>",
            table(&head, rows)
        );
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_told_with_its_tables_and_nothing_of_it_is_markup() {
        let report = serde_json::json!({
            "rows": [{ "name": "<b>", "value": 1.5, "inner": [1] }],
            "warnings": [{ "code": "hole", "message": "x" }],
        });
        let leaf = Leaf {
            kind: "sensor",
            name: "<i>",
            text: "The answer <u>.\nmore",
            report: &report,
            pictures: &[],
            command: "realgap x",
        };
        let page = leaf.page().unwrap();
        for foreign in ["<b>", "<i>", "<u>"] {
            assert!(!page.contains(foreign), "{foreign}");
        }
        assert!(page.contains("<pre tabindex=\"0\">more</pre>") && page.contains("realgap x"));
        assert!(page.contains("id=\"tables\"") && page.contains("What to do: "));
    }
}
