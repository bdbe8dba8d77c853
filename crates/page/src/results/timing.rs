//! `timing.json`: the time that a run took. All other files of a results folder are the same for equal runs.

use std::path::Path;

use serde::Serialize;

use super::kind::file;
use super::write_report;
use realgap_core::error::Result;

/// What a run took; of a run that was resumed, what its last part took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Timing {
    /// From beginning to end, seconds.
    pub wall_s: f64,
    /// CPU seconds of all threads, where the system tells.
    pub cpu_s: Option<f64>,
    /// Threads.
    pub jobs: usize,
}

/// Writes `timing.json` into a results folder.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_timing(folder: &Path, timing: &Timing) -> Result<()> {
    write_report(folder, file::TIMING, timing)
}
