//! A results folder as one page: what its own files say, nothing else.

pub(in crate::report) mod chart;
pub(in crate::report) mod claim;
pub(in crate::report) mod ensemble;
pub(in crate::report) mod fleet;
pub(in crate::report) mod gap;
pub(in crate::report) mod heat;
pub(in crate::report) mod joint;
pub(in crate::report) mod page_data;
pub(in crate::report) mod path;
pub(in crate::report) mod points;
pub(in crate::report) mod prediction;
pub(in crate::report) mod search;
pub(in crate::report) mod sheet;
pub(in crate::report) mod story;
pub(in crate::report) mod study;
pub(in crate::report) mod summary;
pub(in crate::report) mod tree;

use std::path::Path;

use crate::report::document::section::{Section, numbers, provenance, warnings};
use crate::report::folder::page_data::Kept;
use crate::report::folder::tree::Tree;
use crate::report::replay::page::stage;
use crate::results::check_seal;
use crate::results::kind::file;
use realgap_core::error::{Error, Result};

/// Reports that folders hold.
const REPORTS: [&str; 4] = [file::SUMMARY, file::ENSEMBLE, file::GAP, file::PREDICTION];

/// The page of a results folder; `command` is said to have made the page.
///
/// # Errors
/// A folder without a report; files that are not what was written there; unreadable ones; a damaged store.
pub fn folder_page(folder: &Path, command: &str) -> Result<String> {
    let Some(file) = REPORTS.iter().find(|name| folder.join(name).is_file()) else {
        return Err(Error::invalid("no finished results here")
            .at_file(folder)
            .allowed("a folder with summary.json, ensemble.json, gap.json or prediction.json")
            .hint("name a folder that sweep, tune, search, ensemble, gap or predict has written"));
    };
    check_seal(folder)?;
    let path = folder.join(file);
    let report = Tree::read(&path)?;
    let kept = Kept::read(folder)?;
    let kept = kept.as_ref();
    let mut story = match *file {
        file::ENSEMBLE => ensemble::ensemble(folder, &report.typed(&path)?)?,
        file::GAP => gap::gap(folder, &report.typed(&path)?)?,
        file::PREDICTION => prediction::prediction(folder, &report.typed(&path)?)?,
        _ if report.has("search") => search::search(folder, &report.typed(&path)?)?,
        _ => study::story(folder, &report.typed(&path)?, kept)?,
    };
    story.description = report.scalar("description").unwrap_or_default();
    if let Some(shown) = kept.and_then(|kept| kept.replay.as_ref()) {
        let seen = Section::new("replay", "In motion", stage(&shown.scene));
        let at = story.sections.len().min(2);
        story.sections.insert(at, seen);
    }
    let again = kept.map(|kept| kept.command.as_str());
    let again = again.filter(|text| !text.is_empty());
    let own = Some(command).filter(|page| Some(*page) != again);
    story.sections.extend([
        warnings(&report),
        numbers(&report, story.said),
        provenance(&report, again, own),
    ]);
    Ok(story.page(kept))
}
