//! The search itself: proposals evaluated in parallel into the store, in the strategy's order.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::evaluate::Judged;
use super::file::Hunt;
use crate::optimization::{Ending, Evaluation, drive};
use crate::search::Evaluated;
use crate::store::{Mode, Store, TrialScore};
use crate::{Advice, Error, Result};

/// All robots of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Quarry {
    /// In the strategy's order.
    pub robots: Vec<Judged>,
    /// Whether the search is complete.
    pub ending: Ending,
}

/// Where, how, and until when a search runs.
#[derive(Debug, Clone, Copy)]
pub struct Outing<'a> {
    /// The results folder.
    pub folder: &'a Path,
    /// What to do with results that are there.
    pub mode: Mode,
    /// Threads.
    pub jobs: usize,
    /// Set from outside to stop after the robots under way.
    pub stop: &'a AtomicBool,
}

/// Searches. The robots depend on the search alone, not on `jobs` nor on interruptions. `progress` hears how many robots are
/// done and the best fitness so far.
///
/// # Errors
/// A folder that cannot be used, settings that cannot be simulated.
pub fn search(
    hunt: &Hunt,
    outing: &Outing<'_>,
    mut progress: impl FnMut(usize, Option<f64>),
) -> Result<Quarry> {
    let mut store = open(hunt, outing)?;
    let strategy = hunt.plan.strategy();
    let mut robots: Vec<Judged> = Vec::new();
    let mut history: Vec<Evaluated> = Vec::new();
    let mut best: Option<f64> = None;
    let ending = loop {
        let genomes = strategy.propose(&history)?;
        if genomes.is_empty() {
            break Ending::Complete;
        }
        let offset = history.len();
        let evaluation = Evaluation {
            points: offset + genomes.len(),
            jobs: outing.jobs,
            stop: outing.stop,
        };
        let ending = drive(
            &evaluation,
            &mut store,
            |index| hunt.evaluate(index, &genomes[index - offset]),
            |done| progress(done, best),
        )?;
        let trials = store.trials_within(offset..offset + genomes.len())?;
        let judged: Result<Vec<Judged>> = trials.iter().map(|trial| hunt.judge(trial)).collect();
        let judged = judged?;
        store.insert_scores(&judged.iter().map(score).collect::<Vec<_>>())?;
        robots.extend(judged.iter().cloned());
        if ending == Ending::Interrupted {
            // What is there of the batch is no history: the strategy sees whole batches only.
            break Ending::Interrupted;
        }
        for (judged, proposed) in judged.into_iter().zip(genomes) {
            if judged.genome != proposed {
                return Err(
                    Error::conflict("the stored robots are not those of this search")
                        .at_file(outing.folder)
                        .found(format!("robot {}", judged.index))
                        .advise(Advice::Restart),
                );
            }
            let evaluated = Evaluated {
                genome: judged.genome,
                fitness: judged.fitness,
                descriptors: judged.descriptors,
            };
            if let Some(fitness) = evaluated.fitness.filter(|f| !f.is_nan()) {
                best = Some(best.map_or(fitness, |b| b.max(fitness)));
            }
            history.push(evaluated);
        }
        progress(history.len(), best);
    };
    if ending == Ending::Complete {
        store.complete()?;
    }
    Ok(Quarry { robots, ending })
}

fn open(hunt: &Hunt, outing: &Outing<'_>) -> Result<Store> {
    let expected = format!("{} robots", hunt.plan.budget());
    let fingerprint = hunt.fingerprint();
    let mut store = Store::open(
        outing.folder,
        &fingerprint,
        outing.mode,
        "search",
        &expected,
    )?;
    store.describe([
        ("kind", "search".to_owned()),
        ("search", hunt.name.clone()),
        ("search text", hunt.text.clone()),
        ("objective", hunt.objective.label()),
        ("unit", hunt.objective.measure.unit().label().to_owned()),
        (
            "trial",
            "parameters: the genome, ten numbers a module; outcomes: repeats, scores: path length (m), turned (rad); score: fitness, recordings: the archive's descriptors".to_owned(),
        ),
    ])?;
    Ok(store)
}

fn score(judged: &Judged) -> TrialScore {
    TrialScore {
        index: judged.index,
        score: judged.fitness,
        displacement_error_m: None,
        recordings: judged.descriptors.clone(),
    }
}
