//! The sweep: every point of a study, stored as it comes, scored at the end.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::answer::{Answer, Method};
use super::keeping::Keeping;
use super::problem::Problem;
use super::score::Scores;
use crate::error::Result;
use crate::optimization::{Evaluation, drive, pool};
use crate::store::Mode;

/// Evaluates every point of the problem's grid into the store in `folder`.
///
/// The result does not depend on `jobs`, nor on how often the sweep was interrupted and resumed.
///
/// # Errors
/// A folder in use, results of another study in it, a full disk, or a metric that cannot compare.
pub fn sweep(
    problem: &Problem,
    folder: &Path,
    mode: Mode,
    jobs: usize,
    stop: &AtomicBool,
    progress: impl FnMut(usize),
) -> Result<Answer> {
    let grid = &problem.study().grid;
    grid.check_size()
        .map_err(|e| e.at_file(&problem.study().path))?;
    let points = grid.len();
    let keeping = Keeping {
        problem,
        fingerprint: problem.fingerprint(),
        kind: "sweep",
        expected: points,
    };
    let mut store = keeping.open(folder, mode)?;
    let evaluation = Evaluation { points, jobs, stop };
    let ending = drive(
        &evaluation,
        &mut store,
        |index| problem.evaluate(index),
        progress,
    )?;
    let scores = Scores::new(problem, &store.trials()?)?;
    keeping.score(&mut store, &scores.points)?;
    keeping.end(&mut store, ending)?;
    pool(jobs)?.install(|| Answer::new(problem, Method::Sweep, ending, scores))
}
