//! Several results folders on one page: their verdicts and the values of their parameters, beside each other.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::content::PageContent;
use super::summary::VerdictRow;
use super::{Findings, ResultsPage};
use crate::report::document::section::Section;
use crate::report::document::value::*;
use realgap_core::error::{Error, Result};
use realgap_lab::claim::{self, Claim, VERDICT};

/// One of the folders.
struct Column {
    name: String,
    page: ResultsPage,
}

impl Column {
    /// What the folder's page says, without pictures and data.
    fn content(&self) -> PageContent {
        self.page.content(None)
    }

    fn parameters(&self) -> &[VerdictRow] {
        match &self.page.findings {
            Findings::Study(summary, _) => &summary.verdicts,
            _ => &[],
        }
    }
}

/// A page that shows the verdicts of several results folders beside each other, and the values and intervals of their parameters.
/// `command` is the command that makes the page.
///
/// # Errors
/// Fewer than two folders; as [`ResultsPage::read`].
pub fn compared_page(folders: &[PathBuf], command: &str) -> Result<String> {
    if folders.len() < 2 {
        return Err(Error::usage("there is nothing to compare with")
            .found(format!("{} folder", folders.len()))
            .allowed("two results folders or more"));
    }
    let columns = folders.iter().map(|folder| {
        Ok(Column {
            name: shown_name(folder),
            page: ResultsPage::read(folder)?,
        })
    });
    let columns = columns.collect::<Result<Vec<_>>>()?;
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let made = format!(
        "<p class=\"note\">This page was made by: <code>{}</code></p>",
        crate::markup::html(command)
    );
    let page = PageContent {
        kind: "comparison",
        name: names.join(", "),
        answer: "Numbers stand beside each other; they can be compared where robot, recordings and metric are the same.".to_owned(),
        sections: vec![
            Section::new("verdicts", "Verdicts", verdicts(&columns)),
            Section::new("parameters", "Values and 90 % intervals", parameters(&columns)),
            Section::new("made", "Where from", made),
        ],
        ..PageContent::default()
    };
    Ok(page.html(None))
}

/// The last two names of a path.
fn shown_name(folder: &Path) -> String {
    let parts: Vec<String> = (folder.components().rev().take(2))
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    parts.into_iter().rev().collect::<Vec<_>>().join("/")
}

/// A row for each folder, a column for each part of the verdict that any of them has.
fn verdicts(columns: &[Column]) -> String {
    let all: Vec<(PageContent, &Column)> = columns.iter().map(|c| (c.content(), c)).collect();
    let claims: Vec<Vec<(&str, &Claim)>> = (all.iter())
        .map(|(content, _)| claim::verdict(&content.claims))
        .collect();
    let labels: Vec<&str> = (VERDICT.iter().map(|(label, _)| *label))
        .filter(|label| claims.iter().flatten().any(|(own, _)| own == label))
        .collect();
    let rows = all.iter().zip(&claims).map(|((content, column), own)| {
        let said = labels.iter().map(|label| {
            let claim = own.iter().find(|(of, _)| of == label);
            shown(claim.map(|(_, claim)| claim.text.as_str()))
        });
        let first = [column.name.clone(), content.kind.to_owned()];
        first.into_iter().chain(said).collect::<Vec<_>>()
    });
    let head = ["results", "of"].into_iter().chain(labels.iter().copied());
    titled(
        &head.collect::<Vec<_>>().join(" | "),
        rows.collect::<Vec<_>>(),
    )
}

/// A row for each parameter, a column for each folder.
fn parameters(columns: &[Column]) -> String {
    let all = columns.iter().flat_map(Column::parameters);
    let names: BTreeSet<&str> = all.map(|row| row.parameter.as_str()).collect();
    let rows = names.iter().map(|name| {
        let cells = columns.iter().map(|column| {
            let mut own = column.parameters().iter();
            shown(own.find(|row| row.parameter == *name).map(value))
        });
        let first = std::iter::once((*name).to_owned());
        first.chain(cells).collect::<Vec<_>>()
    });
    let names = columns.iter().map(|column| column.name.as_str());
    let head: Vec<&str> = std::iter::once("parameter").chain(names).collect();
    titled(&head.join(" | "), rows.collect::<Vec<_>>())
}

/// `0.180 (0.172 to 0.195)`.
fn value(row: &VerdictRow) -> String {
    let parts = match row.intervals.as_slice() {
        [] => row.interval.as_slice(),
        many => many,
    };
    let parts = parts.iter().map(|[low, high]| span(*low, *high, ""));
    let best = measured(row.best, &row.unit);
    match parts.reduce(|all, part| format!("{all} or {part}")) {
        Some(interval) => format!("{best} ({interval})"),
        None => format!("{best} (not determined)"),
    }
}
