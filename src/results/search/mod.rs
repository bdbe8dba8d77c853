//! What a search leaves in a folder: tables, pictures, the best robots with their cards, a summary.

mod best;
mod draw;
mod picture;
mod summary;
mod table;

use std::path::Path;

use super::write_report;
use crate::error::{Error, Result};
use crate::search::{Finalist, Search, SearchResults};

pub use summary::{BestRobot, SearchSummary};

/// Writes everything into `folder`, next to the store, and returns the summary. Without finalists there are no best robots.
///
/// Every file takes the place of an older one at once, and what an older search left beyond that goes last: whoever stops this
/// midway finds whole files.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_search(
    folder: &Path,
    search: &Search,
    results: &SearchResults,
    finalists: &[Finalist],
) -> Result<SearchSummary> {
    table::write_history(folder, search, results)?;
    let archive = search.strategy().archive(&results.history())?;
    if let Some(archive) = &archive {
        table::write_archive(folder, search, results, archive)?;
    } else {
        remove(&folder.join("archive.csv"))?;
    }
    let mut best = Vec::new();
    for finalist in finalists {
        best.push(best::write(folder, search, finalist)?);
    }
    picture::draw(folder, search, results, archive.as_ref(), finalists)?;
    let summary = SearchSummary::new(search, results, best)?;
    write_report(folder, "summary.json", &summary)?;
    best::remove_others(folder, &summary.best)?;
    Ok(summary)
}

/// Removes a file, if it is there.
fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io("remove an old result", path, &e))
        }
        _ => Ok(()),
    }
}
