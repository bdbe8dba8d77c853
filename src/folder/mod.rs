//! What a results folder holds for people: tables, pictures, a summary, the best values.

mod best;
mod picture;
mod summary;
mod table;
mod verdict;

use std::path::Path;

use crate::error::Result;
use crate::study::{Problem, Sweep};

pub use summary::Summary;
pub use verdict::Verdict;

/// Writes everything into `folder`, next to the store, and returns the summary.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write(folder: &Path, problem: &Problem, sweep: &Sweep) -> Result<Summary> {
    table::write_points(folder, problem, sweep)?;
    table::write_scores(folder, problem, sweep)?;
    let summary = Summary::new(problem, sweep)?;
    summary.write(folder)?;
    best::write(folder, problem, sweep, &summary)?;
    picture::draw(folder, problem, sweep, &summary)?;
    Ok(summary)
}
