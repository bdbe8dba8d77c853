//! The page that `sweep --live` and `tune --live` renew while they run.

use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use realgap::RunOptions;
use realgap::calibration::Study;
use realgap::file::write_atomic;
use realgap::optimization::Progress;
use realgap::report::LivePage;

use super::kit::*;

/// How often the page is written.
const PERIOD: Duration = Duration::from_secs(2);

/// Whether a page is renewed during the run.
#[derive(Debug, Clone, Args)]
pub struct LiveOption {
    /// While the command runs, renew this page (.html) every two seconds: what is done, the map or the trace so far; a browser that
    /// shows it loads it again by itself
    #[arg(long, value_name = "FILE")]
    live: Option<PathBuf>,
}

impl LiveOption {
    /// Checks before the work that the page can be written.
    pub fn check(&self) -> Result<()> {
        self.live.as_deref().map_or(Ok(()), output::check_page)
    }

    /// Does the work, and renews the page while it goes on. A page that cannot be written is a warning, because the results do not
    /// need it.
    pub fn during<T>(
        &self,
        (study, folder): (&Study, &Path),
        is_sweep: bool,
        run: RunOptions<'_>,
        work: impl FnOnce(&RunOptions<'_>) -> Result<T>,
    ) -> Result<T> {
        let Some(file) = &self.live else {
            return work(&run);
        };
        let last = Mutex::new(None);
        let say = |progress: Progress| {
            if let Ok(mut last) = last.lock() {
                *last = Some(progress);
            }
            if let Some(also) = run.progress {
                also(progress);
            }
        };
        let page = |ended: Option<&str>| {
            let page = LivePage {
                study,
                is_sweep,
                folder,
                progress: last.lock().ok().and_then(|last| *last),
                ended,
            };
            page.html()
                .and_then(|page| write_atomic(file, page.as_bytes()))
        };
        let warn = |error: &Error| {
            terminal::print_warnings(&[Code::NotWritten.warning(format!("no live page: {error}"))]);
        };
        // An unwritable place is said before the run.
        page(None)?;
        std::thread::scope(|scope| {
            let (stop, stopped) = mpsc::channel::<()>();
            let renewed = scope.spawn(move || {
                let mut first_error = None;
                while stopped.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                    if let Err(error) = page(None) {
                        first_error.get_or_insert(error);
                    }
                }
                (page, first_error)
            });
            let done = work(&RunOptions {
                progress: Some(&say),
                ..run
            });
            drop(stop);
            if let Ok((page, first_error)) = renewed.join() {
                let answer = format!("the answer is in {}.", folder.display());
                let ended = match &done {
                    Ok(_) => answer,
                    Err(error) => format!("the run has stopped: {}.", error.message()),
                };
                let written = page(Some(&ended));
                if let Some(error) = written.err().or(first_error) {
                    warn(&error);
                }
            }
            done
        })
    }
}
