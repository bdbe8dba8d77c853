//! Evaluates points in parallel, stores the results, reports progress and stops on request.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use super::options::{RunOptions, pool};
use realgap_core::error::{ErrorKind, Result};
use realgap_store::Storage;

/// How a call of [`drive`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Every point has been evaluated.
    Complete,
    /// The evaluation was stopped early; all results that were finished are stored.
    Interrupted,
}

/// A batch of points to be evaluated, whose results go into a storage.
pub struct Batch<'a> {
    /// Number of points of the study.
    pub points: usize,
    /// Number of threads, at least 1.
    pub jobs: usize,
    /// The caller sets this flag to stop. Points that are being evaluated are finished, unless `evaluate` checks the flag itself.
    pub stop: &'a AtomicBool,
}

impl<'a> Batch<'a> {
    /// A batch of `points` points with the threads and the stop flag of these run options.
    pub fn new(points: usize, run: &'a RunOptions<'_>) -> Self {
        Self {
            points,
            jobs: run.jobs,
            stop: run.stop_flag(),
        }
    }
}

/// Evaluates in parallel all points that the storage accepts and does not contain yet, and stores each result as soon as it is
/// finished. If other points are missing that the storage does not accept (because another process evaluates them), the result is
/// [`Ending::Interrupted`].
///
/// Which thread evaluates which point has no influence on any result. `progress` is called on the
/// calling thread with the number of points finished so far, including those that were stored before.
///
/// # Errors
/// The first error of `evaluate` or of the store; all results that were finished before are stored. An evaluation that ends
/// early because of the stop flag is not an error.
pub fn drive<R: Send>(
    batch: &Batch<'_>,
    store: &mut (impl Storage<R> + ?Sized),
    evaluate: impl Fn(usize) -> Result<R> + Sync,
    mut progress: impl FnMut(usize),
) -> Result<Ending> {
    let finished: BTreeSet<usize> = store.finished()?;
    let mut todo: Vec<usize> = (0..batch.points)
        .filter(|index| !finished.contains(index))
        .collect();
    let mut done = batch.points - todo.len();
    store.begin(batch.points);
    todo.retain(|index| store.takes(*index));
    progress(done);
    // A thread without a point of its own helps to simulate the cases of other points.
    let pool = pool(batch.jobs)?;
    let jobs = batch.jobs.clamp(1, todo.len().max(1));
    let next = AtomicUsize::new(0);
    let abort = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel::<Result<R>>();
    let mut first_error = None;
    pool.in_place_scope(|scope| {
        for _ in 0..jobs {
            let (sender, next, abort, todo, evaluate) =
                (sender.clone(), &next, &abort, &todo, &evaluate);
            scope.spawn(move |_| {
                while !abort.load(Ordering::Relaxed) && !batch.stop.load(Ordering::Relaxed) {
                    let Some(&index) = todo.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        break;
                    };
                    let result = evaluate(index);
                    let stopped = batch.stop.load(Ordering::Relaxed);
                    if stopped && matches!(&result, Err(e) if e.kind() == ErrorKind::Interrupted) {
                        break;
                    }
                    if sender.send(result).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        while let Ok(first) = receiver.recv() {
            // All results that have arrived since the last transaction go into the same transaction.
            let mut trials = Vec::new();
            for result in std::iter::once(first).chain(receiver.try_iter()) {
                match result {
                    Ok(trial) => trials.push(trial),
                    Err(error) => {
                        abort.store(true, Ordering::Relaxed);
                        first_error.get_or_insert(error);
                    }
                }
            }
            if let Err(error) = store.insert(&trials) {
                abort.store(true, Ordering::Relaxed);
                first_error.get_or_insert(error);
                continue;
            }
            done += trials.len();
            progress(done);
        }
    });
    match first_error {
        Some(error) => Err(error),
        None if done == batch.points => Ok(Ending::Complete),
        None => Ok(Ending::Interrupted),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::error::Error;
    use realgap_store::{CaseOutcome, CaseRow, Fingerprint, Store, Trial};

    fn trial(index: usize) -> Trial {
        let case = CaseRow {
            steps: index as u64,
            outcome: CaseOutcome::Diverged(format!("at {}", (index as f64).sin())),
        };
        Trial {
            index,
            values: vec![index as f64],
            cases: vec![case],
        }
    }

    #[test]
    fn an_interrupted_evaluation_continues_where_it_stopped_and_ends_with_the_same_bits() {
        let whole = tempfile::tempdir().unwrap();
        let parts = tempfile::tempdir().unwrap();
        let fingerprint = Fingerprint::new();
        let never = AtomicBool::new(false);
        let mut store = Store::create(whole.path(), &fingerprint).unwrap();
        let batch = Batch {
            points: 40,
            jobs: 1,
            stop: &never,
        };
        assert_eq!(
            drive(&batch, &mut store, |i| Ok(trial(i)), |_| ()).unwrap(),
            Ending::Complete
        );

        let stop = AtomicBool::new(false);
        let mut partial = Store::create(parts.path(), &fingerprint).unwrap();
        let batch = Batch {
            points: 40,
            jobs: 3,
            stop: &stop,
        };
        let ending = drive(
            &batch,
            &mut partial,
            |i| {
                if i == 11 {
                    stop.store(true, Ordering::Relaxed);
                }
                Ok(trial(i))
            },
            |_| (),
        );
        assert_eq!(ending.unwrap(), Ending::Interrupted);
        let before = partial.finished().unwrap().len();
        assert!((1..40).contains(&before), "{before}");
        let batch = Batch {
            points: 40,
            jobs: 2,
            stop: &never,
        };
        let mut first_progress = None;
        let ending = drive(
            &batch,
            &mut partial,
            |i| Ok(trial(i)),
            |n| {
                first_progress.get_or_insert(n);
            },
        );
        assert_eq!(ending.unwrap(), Ending::Complete);
        assert_eq!(first_progress, Some(before));
        assert_eq!(partial.trials().unwrap(), store.trials().unwrap());
    }

    #[test]
    fn an_error_stops_the_evaluation_and_keeps_the_finished_results() {
        let folder = tempfile::tempdir().unwrap();
        let never = AtomicBool::new(false);
        let mut store = Store::create(folder.path(), &Fingerprint::new()).unwrap();
        let batch = Batch {
            points: 10,
            jobs: 1,
            stop: &never,
        };
        let error = drive(
            &batch,
            &mut store,
            |i| {
                if i == 4 {
                    Err(Error::invalid("point 4"))
                } else {
                    Ok(trial(i))
                }
            },
            |_| (),
        );
        assert_eq!(error.unwrap_err().message(), "point 4");
        assert!(store.finished().unwrap().len() >= 4);
    }
}
