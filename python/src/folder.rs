//! Reads texts and writes folders as the commands do.

use std::path::{Path, PathBuf};
use std::time::Instant;

use realgap::Result;
use realgap::calibration::Mode;
use realgap::file::Source;
use realgap::optimization::RunOptions;
use realgap::results::{Kind, Timing, check_folder, write_timing};
use realgap::store::FolderLock;

/// The given text; without one, the text of the file.
pub fn source(path: PathBuf, text: Option<String>, is_json: bool, kind: &str) -> Result<Source> {
    match text {
        None => Source::read(path, kind),
        Some(text) if is_json => Ok(Source::json(path, text)),
        Some(text) => Ok(Source::new(path, text)),
    }
}

/// The mode for a folder that holds results already.
pub fn mode_of(text: &str) -> Mode {
    match text {
        "resume" => Mode::Resume,
        "restart" => Mode::Restart,
        _ => Mode::Start,
    }
}

/// Lets `work` write into a folder as the commands do: the folder is locked, foreign files are not replaced, and the time is stored.
pub fn into_folder<T>(
    folder: &Path,
    kind: Kind,
    run: &RunOptions<'_>,
    work: impl FnOnce(&FolderLock) -> Result<T>,
) -> Result<T> {
    check_folder(folder, kind)?;
    let lock = FolderLock::make(folder)?;
    let begun = Instant::now();
    let value = work(&lock)?;
    let timing = Timing {
        wall_s: begun.elapsed().as_secs_f64(),
        // The CPU time of the whole interpreter is not that of this run.
        cpu_s: None,
        jobs: run.jobs,
    };
    write_timing(folder, &timing)?;
    Ok(value)
}
