//! What a search leaves in a folder: tables, pictures, the best robots with their cards, a summary.

mod best;
mod draw;
mod picture;
mod summary;
pub(crate) mod table;

use std::path::{Component, Path};

use super::draft::publish;
use super::kind::{Kind, file};
use super::write_report;
use crate::report::ResultsPage;
use realgap_core::error::Result;
use realgap_lab::search::{Baseline, Finalist, ParameterShare, Search, SearchResults};

pub(super) use best::is_ours;
pub(crate) use picture::fitness_chart;
pub use summary::{BestRobot, SearchSummary};
pub(crate) use table::History;

/// The page in the folder `to`, as a link from a page in the folder `from`, where both are relative to the same folder.
fn page_from(from: &Path, to: &Path) -> Option<String> {
    let is_plain = |path: &Path| path.components().all(|c| matches!(c, Component::Normal(_)));
    if !is_plain(from) || !is_plain(to) || !to.join(file::PAGE[0]).is_file() {
        return None;
    }
    let up = "../".repeat(from.components().count());
    let names = to
        .components()
        .map(|c| c.as_os_str().to_string_lossy().into_owned());
    let names: Vec<String> = names.collect();
    Some(format!("{up}{}/{}", names.join("/"), file::PAGE[0]))
}

/// Writes everything into `folder`, next to the store, and returns the summary and what the page of the folder shows. Without finalists there are no best robots; `baseline` is what they
/// have to beat, where the search started from something; `share` says how much of the best robot's width comes from drawn parameters.
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
    (baseline, share): (Option<&Baseline>, Option<ParameterShare>),
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
        let of_best = cards.first().map_or(&[][..], |(_, card)| &card.claims[..]);
        let summary = SearchSummary::new(search, results, best, (baseline, share))?;
        let mut summary = summary.with_claims(of_best);
        summary.posterior_page = search
            .posterior_from()
            .and_then(|from| page_from(folder, Path::new(from)));
        write_report(draft.folder(), file::SUMMARY, &summary)?;
        let elites = elites.unwrap_or_default();
        let pictures = draft.take_pictures();
        let page = ResultsPage::of_search(&summary, history, elites, &cards, pictures)?;
        Ok((summary, page))
    })
}
