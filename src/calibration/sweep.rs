//! The sweep: every point of a study, stored as it comes, scored at the end.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::answer::Answer;
use super::keeping::Keeping;
use super::method::Method;
use super::score::Scores;
use super::study::Study;
use crate::error::Result;
use crate::optimization::{Evaluation, drive, pool};
use crate::store::Mode;

/// Evaluates every point of the study's grid into the store in `folder`.
///
/// The result does not depend on `jobs`, nor on how often the sweep was interrupted and resumed.
///
/// # Errors
/// A folder in use, results of another study in it, a full disk, or a metric that cannot compare.
pub fn sweep(
    study: &Study,
    folder: &Path,
    mode: Mode,
    jobs: usize,
    stop: &AtomicBool,
    progress: impl FnMut(usize),
) -> Result<Answer> {
    let grid = &study.definition().grid;
    grid.check_size()
        .map_err(|e| study.definition().at_file(e))?;
    let points = grid.len();
    let keeping = Keeping {
        study,
        fingerprint: study.fingerprint(),
        kind: "sweep",
        expected: points,
    };
    let mut store = keeping.open(folder, mode)?;
    let evaluation = Evaluation { points, jobs, stop };
    let ending = drive(
        &evaluation,
        &mut store,
        |index| study.evaluate(index),
        progress,
    )?;
    let scores = Scores::new(study, &store.trials()?)?;
    keeping.score(&mut store, &scores.points)?;
    keeping.end(&mut store, ending)?;
    pool(jobs)?.install(|| Answer::new(study, Method::Sweep, ending, scores))
}
