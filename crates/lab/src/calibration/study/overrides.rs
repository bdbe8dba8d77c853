//! What a caller wants different from a study's file.

use crate::calibration::{BasisRule, ScoreRule, Split};
use realgap_core::{Error, Result};
use realgap_identification::StartState;
use realgap_path::comparison::Metric;
use realgap_path::trajectory::Reading;
use realgap_simulation::parameter::ParameterSet;

/// A part of the recordings: the `offset`-th of every `every`, in order of their paths, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    every: usize,
    offset: usize,
}

impl Part {
    /// A part; offsets 0 to `every` − 1 together are the whole.
    ///
    /// # Errors
    /// An offset that is not below `every`.
    pub fn new(every: usize, offset: usize) -> Result<Self> {
        if offset < every {
            return Ok(Self { every, offset });
        }
        Err(Error::usage("there is no such part of the recordings")
            .found(format!("offset {offset} of every {every}"))
            .allowed("offsets from 0 to one less than `every`"))
    }

    /// Whether the recording at `index` belongs to it.
    pub fn contains(&self, index: usize) -> bool {
        index % self.every == self.offset
    }
}

/// What the caller wants different from the file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Globs of recordings, relative to the current folder, in place of the file's.
    pub recordings: Vec<String>,
    /// Every so many-th recording only, in order of their paths, counted from an offset.
    pub part: Option<Part>,
    /// Start state in place of the file's.
    pub start_state: Option<StartState>,
    /// Only the first so many recordings.
    pub limit_recordings: Option<usize>,
    /// Metric in place of the file's.
    pub metric: Option<&'static dyn Metric>,
    /// Where the basis of `pca` comes from, in place of the file's.
    pub basis: Option<BasisRule>,
    /// What a score is the mean over, in place of the file's.
    pub score: Option<ScoreRule>,
    /// Time of each run in place of the file's, seconds.
    pub duration_s: Option<f64>,
    /// Points per parameter in place of the file's.
    pub points: Option<usize>,
    /// Seed in place of the file's.
    pub seed: Option<u64>,
    /// Fixed values, after the file's own.
    pub set: ParameterSet,
    /// What the fits of these values left possible, a group a fit: every repeat under noise takes one of each.
    pub draws: Vec<Vec<ParameterSet>>,
    /// What the values were fitted on ([`recording_id`](crate::calibration::recording_id)): a warning says which of the recordings are among
    /// them.
    pub fitted_on: Vec<String>,
    /// How the recordings are read, before what the file says of it.
    pub reading: Reading,
    /// Whether recordings stay whole where the study cuts them into windows.
    pub whole_runs: bool,
    /// Whether sets of recordings without a study are cut to the shortest and compared at equal times; a study always does.
    pub equal_times: bool,
    /// Which recordings are kept from the fit to check it.
    pub split: Option<Split>,
}
