//! Options of long computations: the number of threads, the progress callback and the stop flag.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use realgap_core::error::{Advice, Error, Result};

/// The progress of a long computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of points, robots or repeats that are done, including those that were stored before.
    pub done: usize,
    /// Number of points, robots or repeats in all.
    pub total: usize,
    /// The best score or fitness so far, if there is one.
    pub best: Option<f64>,
    /// The name of the current step after all points are done. `done` and `total` then count the runs of this step; `total` is 0
    /// for a step without runs.
    pub finishing: Option<&'static str>,
}

/// Options of a long computation. They do not change any result.
///
/// ```
/// use realgap_optimization::RunOptions;
///
/// let say = |progress: realgap_optimization::Progress| println!("{} of {}", progress.done, progress.total);
/// let options = RunOptions { jobs: 2, progress: Some(&say), ..RunOptions::default() };
/// assert!(!options.is_stopped());
/// ```
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Number of threads, at least 1.
    pub jobs: usize,
    /// The caller sets this flag to stop: no further work is begun, and the results so far are returned.
    pub stop: Option<&'a AtomicBool>,
    /// A callback that receives the progress; it may be called from any thread.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
}

impl Default for RunOptions<'_> {
    /// As many threads as the machine has cores, no progress callback and no stop flag.
    fn default() -> Self {
        Self {
            jobs: std::thread::available_parallelism().map_or(1, usize::from),
            stop: None,
            progress: None,
        }
    }
}

impl RunOptions<'_> {
    /// Whether the stop flag is set.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// The stop flag, or a flag that is never set if the options have none.
    pub fn stop_flag(&self) -> &AtomicBool {
        static NEVER: AtomicBool = AtomicBool::new(false);
        self.stop.unwrap_or(&NEVER)
    }

    /// Returns an error if the stop flag is set, for work whose partial results cannot be used.
    ///
    /// # Errors
    /// The stop flag is set.
    pub fn go_on(&self) -> Result<()> {
        if self.is_stopped() {
            return Err(Error::interrupted("interrupted before the end")
                .hint("run it again; a repeated run gives the same numbers"));
        }
        Ok(())
    }

    /// Runs `work` on a thread pool with [`Self::jobs`] threads.
    ///
    /// # Errors
    /// The system cannot start as many threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R> {
        Ok(pool(self.jobs)?.install(work))
    }

    /// Calls `one` in parallel for every number below `total` and returns the results in the order of the numbers. The progress
    /// callback is called after each.
    ///
    /// # Errors
    /// An error of `one`; the system cannot start as many threads, or the stop flag is set.
    pub fn each<T: Send>(
        &self,
        total: usize,
        one: impl Fn(usize) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let done = AtomicUsize::new(0);
        let reported = |index| {
            self.go_on()?;
            let made = one(index);
            self.tell(done.fetch_add(1, Ordering::Relaxed) + 1, total, None);
            made
        };
        self.install(|| (0..total).into_par_iter().map(reported).collect())?
    }

    /// Calls the progress callback, if there is one.
    pub fn tell(&self, done: usize, total: usize, best: Option<f64>) {
        if let Some(progress) = self.progress {
            progress(Progress {
                done,
                total,
                best,
                finishing: None,
            });
        }
    }

    /// Begins the step `what` after all points are done, which has so many runs.
    pub fn step(&self, what: &'static str, total: usize) -> Step<'_> {
        let step = Step {
            progress: self.progress,
            what,
            total,
            done: AtomicUsize::new(0),
        };
        step.tell(0);
        step
    }
}

/// A step after all points are done, whose runs are counted.
pub struct Step<'a> {
    progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    what: &'static str,
    total: usize,
    done: AtomicUsize,
}

impl Step<'_> {
    /// Counts one more run; it may be called from any thread.
    pub fn count(&self) {
        self.tell(self.done.fetch_add(1, Ordering::Relaxed) + 1);
    }

    fn tell(&self, done: usize) {
        if let Some(progress) = self.progress {
            progress(Progress {
                done,
                total: self.total,
                best: None,
                finishing: Some(self.what),
            });
        }
    }
}

/// A thread pool with this number of threads, for the parallel work of a study.
///
/// # Errors
/// The system cannot start as many threads.
pub fn pool(jobs: usize) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.max(1))
        .build()
        .map_err(|e| {
            Error::conflict(format!("cannot start {jobs} threads: {e}"))
                .advise(Advice::FewerThreads)
        })
}

impl fmt::Debug for Step<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Step")
            .field("what", &self.what)
            .field("done", &self.done)
            .field("total", &self.total)
            .finish()
    }
}

impl fmt::Debug for RunOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RunOptions")
            .field("jobs", &self.jobs)
            .field("stop", &self.stop)
            .field("progress", &self.progress.map(|_| "…"))
            .finish()
    }
}
