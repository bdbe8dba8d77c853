//! The sweep: every point of a study, kept as it comes, scored at the end.

use super::answer::Answer;
use super::keeping::{Keeping, Kept};
use super::method::Method;
use super::score::Scores;
use super::study::Study;
use crate::error::Result;
use crate::optimization::{Batch, RunOptions, drive};
use crate::store::{Mode, Place};

impl Study {
    /// Simulates every point of the study's grid and says what cannot be told from the best.
    ///
    /// The answer does not depend on the threads.
    ///
    /// # Errors
    /// A grid too large to be swept, or a metric that cannot compare.
    pub fn sweep(&self, run: &RunOptions<'_>) -> Result<Answer> {
        sweep(self, None, run)
    }

    /// As [`Study::sweep`], with every trial kept in a folder as it comes: an interrupted sweep can go on, and the answer has
    /// the same bits however often that happened.
    ///
    /// # Errors
    /// As [`Study::sweep`]; a folder in use, results of another study in it, a full disk.
    pub fn sweep_into<'a>(
        &self,
        place: impl Into<Place<'a>>,
        mode: Mode,
        run: &RunOptions<'_>,
    ) -> Result<Answer> {
        sweep(self, Some((place.into(), mode)), run)
    }
}

fn sweep(study: &Study, place: Option<(Place<'_>, Mode)>, run: &RunOptions<'_>) -> Result<Answer> {
    let grid = &study.definition().grid;
    grid.check_size()
        .map_err(|e| study.definition().at_file(e))?;
    let points = grid.len();
    let kept = Kept {
        study,
        fingerprint: study.fingerprint(),
        kind: "sweep",
        expected: points,
    };
    let mut keeping = Keeping::open(&kept, place)?;
    let batch = Batch {
        points,
        jobs: run.jobs,
        stop: run.stop_flag(),
    };
    let ending = drive(
        &batch,
        &mut keeping,
        |index| study.simulate(index),
        |done| run.tell(done, points, None),
    )?;
    let scores = Scores::new(study, &keeping.trials()?)?;
    keeping.score(&scores.points)?;
    keeping.end(ending)?;
    run.install(|| Answer::new(study, Method::Sweep, ending, scores))?
}
