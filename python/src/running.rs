//! Runs work without the interpreter's lock on a thread of its own, while the calling thread listens for Ctrl-C and reports the
//! progress.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use realgap::optimization::{Progress, RunOptions};
use realgap::{Error, Result};

use crate::error::{self, Raise};

/// How often signals are checked.
const PERIOD: Duration = Duration::from_millis(50);

/// Options of a long run.
pub struct Way<'py> {
    /// Number of threads; `None` means one per core.
    pub jobs: Option<i64>,
    /// Called with done, total, best, and the final step.
    pub progress: Option<Bound<'py, PyAny>>,
}

/// More threads than this only compete for the cores.
fn most_jobs() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (4 * cores).max(256)
}

/// The number of threads; `None` means one per core.
///
/// # Errors
/// Not a number of threads.
pub fn jobs(asked: Option<i64>) -> Result<usize> {
    let Some(asked) = asked else {
        return Ok(std::thread::available_parallelism().map_or(1, usize::from));
    };
    let most = most_jobs();
    match usize::try_from(asked) {
        Ok(jobs) if (1..=most).contains(&jobs) => Ok(jobs),
        _ => Err(Error::usage("not a number of threads")
            .field("jobs")
            .found(asked)
            .allowed(format!("1 to {most}"))),
    }
}

enum Said {
    Progress(Progress),
    Ended,
}

/// Does `work` and returns its result; Ctrl-C and a progress callback that raises stop the work by its options.
///
/// # Errors
/// The error of the work, which says how far it got where it was interrupted; the exception of the callback.
pub fn run<T: Send>(
    py: Python<'_>,
    way: &Way<'_>,
    work: impl FnOnce(&RunOptions<'_>) -> Result<T> + Send,
) -> PyResult<T> {
    let jobs = jobs(way.jobs).or_raise(py)?;
    let stop = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    let receiver = Mutex::new(receiver);
    let tell = {
        let sender = sender.clone();
        move |progress| {
            // Sending fails where the calling thread has stopped listening, which is not an error.
            let _unheard = sender.send(Said::Progress(progress));
        }
    };
    let mut stopped = None;
    let value = std::thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let options = RunOptions {
                jobs,
                stop: Some(&stop),
                progress: Some(&tell),
            };
            let value = work(&options);
            let _unheard = sender.send(Said::Ended);
            value
        });
        loop {
            let (last, has_ended) = py.detach(|| listen(&receiver));
            let heard = py
                .check_signals()
                .and_then(|()| match (last, &way.progress) {
                    (Some(progress), Some(callback)) if stopped.is_none() => {
                        report(callback, progress)
                    }
                    _ => Ok(()),
                });
            if let Err(exception) = heard {
                stop.store(true, Ordering::Relaxed);
                stopped.get_or_insert(exception);
            }
            if has_ended || worker.is_finished() {
                break;
            }
        }
        py.detach(|| worker.join())
    });
    let value = value.unwrap_or_else(|_| {
        Err(Error::invalid(
            "a bug: the work ended in a panic, whose text is on standard error",
        ))
    });
    match (stopped, value) {
        (Some(exception), value) if exception.is_instance_of::<PyKeyboardInterrupt>(py) => {
            let whole = || {
                Error::interrupted("interrupted when the work was done")
                    .hint("run it again; the same numbers come out")
            };
            let raised = error::exception(py, value.err().unwrap_or_else(whole));
            raised.set_cause(py, Some(exception));
            Err(raised)
        }
        (Some(exception), _) => Err(error::exception(
            py,
            error::raised(py, "the progress callback", exception),
        )),
        (None, value) => value.or_raise(py),
    }
}

/// The last progress of those that have piled up, and whether the work has ended.
fn listen(receiver: &Mutex<Receiver<Said>>) -> (Option<Progress>, bool) {
    let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
    let mut last = None;
    let first = receiver.recv_timeout(PERIOD).into_iter();
    for said in first.chain(receiver.try_iter()) {
        match said {
            Said::Progress(progress) => last = Some(progress),
            Said::Ended => return (last, true),
        }
    }
    (last, false)
}

fn report(callback: &Bound<'_, PyAny>, progress: Progress) -> PyResult<()> {
    let Progress {
        done,
        total,
        best,
        finishing,
    } = progress;
    callback.call1((done, total, best, finishing)).map(drop)
}
