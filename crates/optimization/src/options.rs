//! How something long runs: threads, who hears of it, and when to stop.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use realgap_core::error::{Advice, Error, Result};

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Points, robots or repeats that are done, stored ones included.
    pub done: usize,
    /// Of so many.
    pub total: usize,
    /// The best score or fitness so far, where there is one.
    pub best: Option<f64>,
    /// What is done with the results once all of them are there; nothing is counted then.
    pub finishing: Option<&'static str>,
}

/// How something long runs. None of it changes a result.
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
    /// Threads, at least 1.
    pub jobs: usize,
    /// Once it is set from outside, nothing new is begun and what is done is returned.
    pub stop: Option<&'a AtomicBool>,
    /// Hears how far the run is; may be called from any thread.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
}

impl Default for RunOptions<'_> {
    /// As many threads as the machine has cores; nobody listens, nothing stops it.
    fn default() -> Self {
        Self {
            jobs: std::thread::available_parallelism().map_or(1, usize::from),
            stop: None,
            progress: None,
        }
    }
}

impl RunOptions<'_> {
    /// Whether somebody asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// The flag that stops it: one that is never set where nobody gave one.
    pub fn stop_flag(&self) -> &AtomicBool {
        static NEVER: AtomicBool = AtomicBool::new(false);
        self.stop.unwrap_or(&NEVER)
    }

    /// For work that is nothing before it is whole.
    ///
    /// # Errors
    /// Somebody asked to stop.
    pub fn go_on(&self) -> Result<()> {
        if self.is_stopped() {
            return Err(Error::interrupted("interrupted before the end")
                .hint("run it again; the same numbers come out"));
        }
        Ok(())
    }

    /// Does `work` on so many threads.
    ///
    /// # Errors
    /// More threads than the system gives.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R> {
        Ok(pool(self.jobs)?.install(work))
    }

    /// What `one` makes of every number below `total`, in their order; whoever listens hears of each.
    ///
    /// # Errors
    /// The first of `one`; more threads than the system gives, or somebody asked to stop.
    pub fn each<T: Send>(
        &self,
        total: usize,
        one: impl Fn(usize) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let done = AtomicUsize::new(0);
        let told = |index| {
            self.go_on()?;
            let made = one(index);
            self.tell(done.fetch_add(1, Ordering::Relaxed) + 1, total, None);
            made
        };
        self.install(|| (0..total).into_par_iter().map(told).collect())?
    }

    /// Tells whoever listens.
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

    /// Tells whoever listens that the counted work, so many points, is over, and what is done now.
    pub fn tell_finishing(&self, what: &'static str, done: usize) {
        if let Some(progress) = self.progress {
            progress(Progress {
                done,
                total: done,
                best: None,
                finishing: Some(what),
            });
        }
    }
}

/// Threads for everything that a study does in parallel.
///
/// # Errors
/// More threads than the system gives.
pub fn pool(jobs: usize) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.max(1))
        .build()
        .map_err(|e| {
            Error::conflict(format!("cannot start {jobs} threads: {e}"))
                .advise(Advice::FewerThreads)
        })
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
