//! What a search leaves in a folder: tables, pictures, the best robots with their cards, a summary.

mod best;
mod draw;
mod picture;
mod summary;
pub(crate) mod table;

use std::path::Path;

use super::draft::publish;
use super::kind::{Kind, file};
use super::write_report;
use crate::report::ResultsPage;
use realgap_core::error::Result;
use realgap_lab::search::{Baseline, Finalist, Search, SearchResults};

pub(super) use best::is_ours;
pub(crate) use picture::fitness_chart;
pub use summary::{BestRobot, SearchSummary};
pub(crate) use table::History;

/// Writes everything into `folder`, next to the store, and returns the summary and what the page of the folder shows. Without finalists there are no best robots; `baseline` is what they
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
) -> Result<(SearchSummary, ResultsPage)> {
    publish(folder, Kind::Search, |draft| {
        let history = table::history(search, results);
        draft.table(file::HISTORY, &history)?;
        let archive = search.strategy().archive(&results.history())?;
        let elites = archive.as_ref();
        let elites = elites.map(|archive| table::archive(search, results, archive));
        if let Some(elites) = &elites {
            draft.table(file::ARCHIVE, elites)?;
        }
        let (mut best, mut cards) = (Vec::new(), Vec::new());
        for finalist in finalists {
            let robot = best::write(draft.folder(), search, finalist)?;
            cards.push((robot.file.clone(), finalist.card()));
            best.push(robot);
        }
        let history = History::of(&history);
        let archive = archive.as_ref();
        picture::draw(draft, search, results, &history, archive, finalists)?;
        let summary = SearchSummary::new(search, results, best, baseline)?;
        write_report(draft.folder(), file::SUMMARY, &summary)?;
        let elites = elites.unwrap_or_default();
        let pictures = draft.take_pictures();
        let page = ResultsPage::of_search(&summary, history, elites, &cards, pictures)?;
        Ok((summary, page))
    })
}
