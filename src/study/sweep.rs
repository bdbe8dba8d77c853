//! The sweep: every point of a study, stored as it comes, scored at the end.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::file::StartRule;
use super::problem::Problem;
use super::score::Scores;
use crate::error::{Error, Result};
use crate::simulation::Noise;
use crate::statistic::standard_deviation;
use crate::store::{OutcomeStatus, STORE_FILE, Store};
use crate::tuning::{
    Ending, Evaluation, Uncertainty, bootstrap_indistinguishable, drive, spread_indistinguishable,
};

/// What to do with results that are already in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Start; results of the same study that are complete are made again, any others are refused.
    #[default]
    Start,
    /// Go on where an interrupted sweep of the same study stopped.
    Resume,
    /// Remove old results first.
    Restart,
}

/// Result of a sweep.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Complete, or stopped early.
    pub ending: Ending,
    /// Scores of the points evaluated so far.
    pub scores: Scores,
    /// What cannot be told apart from the best; `None` where nothing has a score.
    pub uncertainty: Option<Uncertainty>,
}

/// Confidence level of the indistinguishable set.
pub const LEVEL: f64 = 0.95;
/// Perturbed repeats of the best point: how much a score depends on the very start.
const REPEATS: u64 = 16;

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
) -> Result<Sweep> {
    let mut store = open(problem, folder, mode)?;
    let points = problem.study().grid.len();
    let evaluation = Evaluation { points, jobs, stop };
    let ending = drive(
        &evaluation,
        &mut store,
        |index| problem.evaluate(index),
        progress,
    )?;
    let scores = Scores::new(problem, &store.trials()?)?;
    let uncertainty = match scores.best {
        Some(best) => Some(uncertainty(problem, &scores, best)?),
        None => None,
    };
    Ok(Sweep {
        ending,
        scores,
        uncertainty,
    })
}

fn open(problem: &Problem, folder: &Path, mode: Mode) -> Result<Store> {
    let fingerprint = problem.fingerprint();
    match mode {
        Mode::Resume => Store::resume(folder, &fingerprint),
        Mode::Restart => {
            Store::remove(folder)?;
            Store::create(folder, &fingerprint)
        }
        Mode::Start => {
            if folder.join(STORE_FILE).exists() {
                let old = Store::resume(folder, &fingerprint)?;
                let finished = old.finished()?.len();
                drop(old);
                let points = problem.study().grid.len();
                if finished < points {
                    return Err(Error::conflict("the folder holds an unfinished sweep of this study")
                        .at_file(folder)
                        .found(format!("{finished} of {points} points"))
                        .hint("go on with --resume, start anew with --restart, or choose another folder with -o"));
                }
                // Complete and of the same study: made again, the same bits will come out.
                Store::remove(folder)?;
            }
            Store::create(folder, &fingerprint)
        }
    }
}

fn uncertainty(problem: &Problem, scores: &Scores, best: usize) -> Result<Uncertainty> {
    let study = problem.study();
    let values = &scores.points[best].values;
    if study.recordings.len() >= 2 {
        let all: Vec<Option<Vec<f64>>> = scores
            .points
            .iter()
            .map(|point| point.score.map(|_| point.recordings.clone()))
            .collect();
        // Where every recording has its own start, each score is a draw of its own and the bootstrap sees the
        // noise of single simulations; one simulation for all recordings hides it.
        let simulation_sd = match study.start {
            StartRule::Settled => {
                standard_deviation(&repeats(problem, scores, values, &Noise::careful_start())?)
            }
            StartRule::FromRecording => 0.0,
        };
        return Ok(bootstrap_indistinguishable(
            &all,
            best,
            simulation_sd,
            LEVEL,
            study.seed,
        ));
    }
    let repeats = repeats(problem, scores, values, &Noise::careful_repeat())?;
    let all: Vec<Option<f64>> = scores.points.iter().map(|point| point.score).collect();
    Ok(spread_indistinguishable(&all, best, &repeats, LEVEL))
}

/// Scores of repeats of the best point; diverged ones are left out.
///
/// Every repeat starts a little differently and takes another timestep, from the study's down to half of it:
/// for a walking robot the timestep does not converge (docs/fidelity.md), so a finer one is as good a choice,
/// and what it changes belongs to the uncertainty.
fn repeats(problem: &Problem, scores: &Scores, values: &[f64], noise: &Noise) -> Result<Vec<f64>> {
    let mut repeats = Vec::new();
    for repeat in 0..REPEATS {
        let timestep_factor = 0.5_f64.powf(repeat as f64 / (REPEATS - 1) as f64);
        let outcome = problem.evaluate_perturbed(values, noise, repeat, timestep_factor)?;
        if outcome.status == OutcomeStatus::Completed {
            let scores = scores.outcome_scores(problem, values, 0, &outcome)?;
            repeats.push(scores.iter().sum::<f64>() / scores.len() as f64);
        }
    }
    Ok(repeats)
}
