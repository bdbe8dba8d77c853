//! What a search leaves in a folder: tables, pictures, the best robots with their cards, a summary.

mod best;
mod draw;
mod picture;
mod summary;
mod table;

use std::path::Path;

use super::draft::publish;
use super::kind::{Kind, file};
use super::write_report;
use realgap_core::error::Result;
use realgap_lab::search::{Baseline, Finalist, Search, SearchResults};

pub(super) use best::is_ours;
pub use summary::{BestRobot, SearchSummary};

/// Writes everything into `folder`, next to the store, and returns the summary. Without finalists there are no best robots; `baseline` is what they
/// have to beat, where the search started from something.
///
/// They take the place of those of an older search once all of them are written.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_search(
    folder: &Path,
    search: &Search,
    results: &SearchResults,
    finalists: &[Finalist],
    baseline: Option<&Baseline>,
) -> Result<SearchSummary> {
    publish(folder, Kind::Search, |draft| {
        table::write_history(draft, search, results)?;
        let archive = search.strategy().archive(&results.history())?;
        if let Some(archive) = &archive {
            table::write_archive(draft, search, results, archive)?;
        }
        let mut best = Vec::new();
        for finalist in finalists {
            best.push(best::write(draft, search, finalist)?);
        }
        picture::draw(draft, search, results, archive.as_ref(), finalists)?;
        let summary = SearchSummary::new(search, results, best, baseline)?;
        write_report(draft, file::SUMMARY, &summary)?;
        Ok(summary)
    })
}
