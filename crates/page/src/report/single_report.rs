//! The page of a single report: what a command without a results folder found.

use std::path::Path;

use crate::report::document::page::html;
use crate::report::document::picture::{beside, embedded};
use crate::report::document::section::{Section, numbers, provenance, warnings};
use crate::report::folder::content::PageContent;
use crate::report::folder::tree::ReportTree;
use realgap_core::error::{Error, Result};
use realgap_lab::claim::verdict_lines;

/// The findings of one command.
#[derive(Debug)]
pub struct SingleReport<'a> {
    /// The kind of findings: `sensor`, `radio`, …
    pub kind: &'static str,
    /// What the findings are about, e.g. the name of the log.
    pub name: &'a str,
    /// The text that the command prints: its first line is the answer.
    pub text: &'a str,
    /// The findings as data.
    pub report: &'a ReportTree,
    /// Pictures that were drawn of it.
    pub pictures: &'a [&'a Path],
    /// The command.
    pub command: &'a str,
}

impl SingleReport<'_> {
    /// The page: one HTML file.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn page(&self) -> Result<String> {
        // The verdict stands on top by itself, as on the page of a results folder.
        let claims = self.report.claims();
        let verdict = verdict_lines(&claims);
        let text = self.text.trim();
        let mut lines = text
            .strip_prefix(verdict.trim())
            .unwrap_or(text)
            .trim_start()
            .lines();
        let answer = lines.next();
        let answer = answer.unwrap_or("What was found is in the tables below.");
        let rest: Vec<String> = lines.map(html).collect();
        let found = match rest.is_empty() {
            true => String::new(),
            false => format!("<pre tabindex=\"0\">{}</pre>", rest.join("\n")),
        };
        let sections = vec![
            Section::new("found", "What was found", found),
            Section::new("pictures", "Pictures", self.figures()?),
            Section::new("tables", "Tables", self.report.tables()),
            warnings(self.report),
            numbers(self.report, ""),
            provenance(self.report, Some(self.command), None),
        ];
        let content = PageContent {
            kind: self.kind,
            name: self.name.to_owned(),
            claims,
            answer: answer.to_owned(),
            sections,
            ..PageContent::default()
        };
        Ok(content.html(None))
    }

    fn figures(&self) -> Result<String> {
        let mut all = String::new();
        for path in self.pictures {
            let kind = match path.extension().and_then(|ending| ending.to_str()) {
                Some("svg") => "image/svg+xml",
                _ => "image/png",
            };
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let bytes = std::fs::read(path).map_err(|e| Error::io("read the file", path, &e))?;
            all += &embedded(&bytes, kind, &name);
        }
        Ok(beside(&all))
    }
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
        let report_of = SingleReport {
            kind: "sensor",
            name: "<i>",
            text: "The answer <u>.\nmore",
            report: &ReportTree::of(&report).unwrap(),
            pictures: &[],
            command: "realgap x",
        };
        let page = report_of.page().unwrap();
        for foreign in ["<b>", "<i>", "<u>"] {
            assert!(!page.contains(foreign), "{foreign}");
        }
        assert!(page.contains("<pre tabindex=\"0\">more</pre>") && page.contains("realgap x"));
        assert!(page.contains("id=\"tables\"") && page.contains("What to do: "));
    }
}
