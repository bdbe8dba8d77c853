//! Settings of a caller that take the place of those in a study's file.

use crate::calibration::{BasisRule, CommandConsent, ScoreRule, Split};
use realgap_core::{Error, Result};
use realgap_identification::StartState;
use realgap_path::comparison::Metric;
use realgap_path::trajectory::Reading;
use realgap_simulation::parameter::ParameterSet;

/// A part of the recordings: every `every`-th, beginning with number `offset`, in the order of their paths and counted from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    every: usize,
    offset: usize,
}

impl Part {
    /// A part. The parts with offsets 0 to `every` − 1 together are all recordings.
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

/// Settings of a caller that take the place of those in the file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Globs of recordings, relative to the current folder, in place of the file's.
    pub recordings: Vec<String>,
    /// A part of the recordings only.
    pub part: Option<Part>,
    /// Start state in place of the file's.
    pub start_state: Option<StartState>,
    /// Only the first so many recordings.
    pub limit_recordings: Option<usize>,
    /// Metric in place of the file's.
    pub metric: Option<&'static dyn Metric>,
    /// Where the basis of `pca` comes from, in place of the file's.
    pub basis: Option<BasisRule>,
    /// Over what a score is the mean, in place of the file's rule.
    pub score: Option<ScoreRule>,
    /// Time of each run in place of the file's, seconds.
    pub duration_s: Option<f64>,
    /// Points per parameter in place of the file's.
    pub points: Option<usize>,
    /// Seed in place of the file's.
    pub seed: Option<u64>,
    /// Fixed values, after the file's own.
    pub set: ParameterSet,
    /// Posterior draws of these values, a group per fit: every repeat under noise takes one draw of each group.
    pub draws: Vec<Vec<ParameterSet>>,
    /// Identifiers ([`recording_id`](crate::calibration::recording_id)) of the recordings on which the values were fitted: a
    /// warning names those of them that the study compares with.
    pub fitted_on: Vec<String>,
    /// How the recordings are read; it takes precedence over the file's setting.
    pub reading: Reading,
    /// Whether recordings stay whole where the study cuts them into windows.
    pub whole_runs: bool,
    /// Whether recordings without a study are cut to the shortest one and compared at equal times; a study always does this.
    pub equal_times: bool,
    /// Whether the command that the study names may be run.
    pub command: CommandConsent,
    /// Which recordings are held out of the fit to check it.
    pub split: Option<Split>,
}
