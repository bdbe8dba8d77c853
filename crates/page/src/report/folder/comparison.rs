//! Several results folders on one page: their verdicts and the values of their parameters, beside each other.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::content::{PageContent, verdict};
use super::summary::VerdictRow;
use super::{Findings, ResultsPage};
use crate::report::document::page::html;
use crate::report::document::section::{Section, figures};
use crate::report::document::value::*;
use realgap_core::error::{Error, Result};

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
        html(command)
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

/// The verdict of each folder, beside each other where there is room.
fn verdicts(columns: &[Column]) -> String {
    let all = columns.iter().map(|column| {
        let content = column.content();
        format!(
            "<figure><h3>{} ({})</h3>{}</figure>",
            html(&column.name),
            content.kind,
            verdict(&content.claims)
        )
    });
    figures(&all.collect::<Vec<_>>())
}

/// The rows of each parameter, one for each folder that has it.
fn parameters(columns: &[Column]) -> String {
    let all = columns.iter().flat_map(Column::parameters);
    let names: BTreeSet<&str> = all.map(|row| row.parameter.as_str()).collect();
    let rows = names.iter().flat_map(|name| {
        columns.iter().filter_map(move |column| {
            let mut own = column.parameters().iter();
            let row = own.find(|row| row.parameter == *name)?;
            Some(vec![(*name).to_owned(), value(row), column.name.clone()])
        })
    });
    titled(
        "parameter | value (90 % interval) | results",
        rows.collect::<Vec<_>>(),
    )
}

/// `0.180 (0.172 to 0.195)`, or that it is not determined.
fn value(row: &VerdictRow) -> String {
    if row.identified == Some(false) {
        let best = measured(row.best, &row.unit);
        return format!("not determined (best {best})");
    }
    let parts = match row.intervals.as_slice() {
        [] => row.interval.as_slice(),
        many => many,
    };
    let parts = parts.iter().map(|[low, high]| span(*low, *high, ""));
    let best = measured(row.best, &row.unit);
    match parts.reduce(|all, part| format!("{all} or {part}")) {
        Some(interval) => format!("{best} ({interval})"),
        None => best,
    }
}
