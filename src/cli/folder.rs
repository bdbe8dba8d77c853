//! The results folder of a command: it is locked until the last file is written, and checked every second.

use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use realgap::Result;
use realgap::results::{Kind, Timing, check_folder, write_timing};
use realgap::store::FolderLock;

use super::{interrupt, terminal};

/// How often the folder is checked.
const PERIOD: Duration = Duration::from_secs(1);
/// How long the work may take to stop once the folder is gone.
const GRACE: Duration = Duration::from_millis(1500);

/// A results folder in use.
pub struct ResultsFolder {
    lock: FolderLock,
    begun: Instant,
    watch: Option<(Sender<()>, JoinHandle<()>)>,
}

impl ResultsFolder {
    /// Makes and locks the folder, for results of this kind.
    ///
    /// # Errors
    /// A folder that cannot be written, that another process writes into, or that holds files with
    /// the names of results that realgap did not write.
    pub fn take(folder: &Path, kind: Kind) -> Result<Self> {
        // From here on, Ctrl-C stops the run, and the results so far are written.
        interrupt::stop_flag();
        check_folder(folder, kind)?;
        let lock = FolderLock::make(folder)?;
        let (end, ended) = mpsc::channel();
        let watched = lock.clone();
        let watch = std::thread::Builder::new().spawn(move || {
            while ended.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                let Err(error) = watched.check() else {
                    continue;
                };
                // Results can no longer be stored, so the run must stop.
                interrupt::stop();
                if ended.recv_timeout(GRACE) == Err(RecvTimeoutError::Timeout) {
                    terminal::print_error(&error);
                    std::process::exit(1);
                }
                return;
            }
        });
        Ok(Self {
            lock,
            begun: Instant::now(),
            watch: watch.ok().map(|thread| (end, thread)),
        })
    }

    /// The lock, for a store that writes results during the run.
    pub fn lock(&self) -> &FolderLock {
        &self.lock
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.lock.folder()
    }

    /// Checks that the folder still exists, before anything is written into it.
    ///
    /// # Errors
    /// The folder was removed or made read-only during the run.
    pub fn check(&self) -> Result<()> {
        self.lock.check()
    }
}

impl ResultsFolder {
    /// Writes the time that the run took.
    ///
    /// # Errors
    /// A full disk or an unwritable folder.
    pub fn write_timing(&self, jobs: usize) -> Result<()> {
        let timing = Timing {
            wall_s: self.begun.elapsed().as_secs_f64(),
            cpu_s: process_cpu_s(),
            jobs,
        };
        write_timing(self.path(), &timing)
    }
}

/// CPU seconds of all threads so far, where the operating system reports them.
#[cfg(unix)]
fn process_cpu_s() -> Option<f64> {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64)
}

/// CPU seconds of all threads so far, where the operating system reports them.
#[cfg(not(unix))]
fn process_cpu_s() -> Option<f64> {
    None
}

impl Drop for ResultsFolder {
    fn drop(&mut self) {
        if let Some((end, thread)) = self.watch.take() {
            drop(end);
            let _ended = thread.join();
        }
    }
}
