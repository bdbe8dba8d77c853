//! The sweep: every point of a study's grid is simulated and stored, and all are scored at the end.

use crate::calibration::answer::INFERRING;
use crate::calibration::exploration::trial_sink::{RunDescription, TrialSink};
use crate::calibration::exploration::wave::{WAVES, next_wave, runs_a_wave};
use crate::calibration::{Answer, Method, Scores, Study};
use realgap_core::Result;
use realgap_optimization::{Batch, Ending, RunOptions, drive};
use realgap_store::{Mode, Part, Place};

impl Study {
    /// Simulates every point of the study's grid, each with one of the equally valid settings, then waves of further points near
    /// the best ones, also between the points of the grid. The answer has the best point, the confidence set and a verdict per
    /// parameter.
    ///
    /// The answer does not depend on the number of threads.
    ///
    /// # Errors
    /// A grid that is too large to be swept, or a metric that cannot compare the paths.
    pub fn sweep(&self, run: &RunOptions<'_>) -> Result<Answer> {
        sweep(self, None, run)
    }

    /// As [`Study::sweep`], with every trial stored in a folder as soon as it is finished: an interrupted sweep can be resumed,
    /// and the answer has the same bits however often it was interrupted.
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

    /// Simulates one worker's share of the current batch of a distributed sweep and stops there. The ending is "interrupted"
    /// unless all shares are merged already. The points of the next batch depend on all of this one, so the shares are merged
    /// first.
    ///
    /// # Errors
    /// As [`Study::sweep_into`].
    pub(crate) fn sweep_part(&self, part: &mut Part, run: &RunOptions<'_>) -> Result<Ending> {
        simulate(self, &mut TrialSink::Part(part), run)
    }
}

fn sweep(study: &Study, place: Option<(Place<'_>, Mode)>, run: &RunOptions<'_>) -> Result<Answer> {
    let kept = RunDescription {
        study,
        fingerprint: study.fingerprint(),
        kind: "sweep",
        expected: points(study)?,
    };
    let mut sink = TrialSink::open(&kept, place)?;
    let ending = simulate(study, &mut sink, run)?;
    run.step(INFERRING, 0);
    let scores = Scores::new(study, &sink.trials()?)?;
    sink.score(&scores.runs)?;
    sink.end(ending)?;
    run.install(|| Answer::new((study, run), Method::Sweep, ending, scores, None, None))?
}

/// Points of the grid.
fn points(study: &Study) -> Result<usize> {
    let grid = &study.definition().grid;
    grid.check_size()
        .map_err(|e| study.definition().at_file(e))?;
    Ok(grid.len())
}

/// Simulates the grid and the waves after it.
fn simulate(study: &Study, sink: &mut TrialSink<'_>, run: &RunOptions<'_>) -> Result<Ending> {
    let points = points(study)?;
    let again = runs_a_wave(study, points);
    let total = points + WAVES * again;
    let mut ending = drive(
        &Batch::new(points, run),
        sink.rows_mut(),
        |index| study.simulate(index),
        |done| run.tell(done, total, None),
    )?;
    let mut from = points;
    for _ in 0..WAVES {
        if ending == Ending::Interrupted || again == 0 {
            break;
        }
        let scores = Scores::new(study, &sink.rows().rows_within(0..from)?)?;
        let best = scores.best.and_then(|best| scores.points[best].score);
        let chosen: Vec<Vec<f64>> = run.install(|| next_wave(study, &scores, from, again))??;
        if chosen.is_empty() {
            break;
        }
        ending = drive(
            &Batch::new(from + chosen.len(), run),
            sink.rows_mut(),
            |index| study.simulate_trial(index, chosen[index - from].clone(), false),
            |done| run.tell(done, total, best),
        )?;
        from += chosen.len();
    }
    Ok(ending)
}
