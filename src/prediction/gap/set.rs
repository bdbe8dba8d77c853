//! Repeats that have no study: the recordings of one condition, of any robot.

use std::path::Path;

use super::sample::Sample;
use crate::calibration::{Overrides, recording_paths, recording_warnings};
use crate::error::{Advice, Error, Result};
use crate::trajectory::{self, Recording};
use crate::warning::Warning;

/// Name of the set of recordings that no column puts into another.
const UNNAMED: &str = "all recordings";

/// Recordings that repeat the same experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct SetOfRuns {
    /// Value of the grouping column, or "all recordings".
    pub name: String,
    /// The runs.
    pub runs: Vec<Sample>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Reads the recordings that `overrides` names (globs relative to the current folder), in sets: one for each value of
/// `group_column`, in order of first appearance.
///
/// Without a column named, long-format files with a column `condition` are grouped by it; all others are one set.
/// [`read_sets`](trajectory::read_sets) says which rows belong together.
///
/// # Errors
/// No recordings, unreadable ones, a column that a file does not have.
pub fn read_sets(overrides: &Overrides, group_column: Option<&str>) -> Result<Vec<SetOfRuns>> {
    if overrides.recordings.is_empty() {
        return Err(
            Error::usage("without a study, the recordings must be named")
                .advise(Advice::Recordings),
        );
    }
    let limit = overrides.limit_recordings.unwrap_or(usize::MAX).max(1);
    let mut sets: Vec<(String, Vec<Recording>)> = Vec::new();
    let (mut index, mut taken) = (0, 0);
    for path in recording_paths(&overrides.recordings, Path::new(""))? {
        for (name, recording) in trajectory::read_sets(&path, overrides.unit, group_column)? {
            if taken < limit && overrides.part.is_none_or(|part| part.contains(index)) {
                taken += 1;
                match sets.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, recordings)) => recordings.push(recording),
                    None => sets.push((name, vec![recording])),
                }
            }
            index += 1;
        }
    }
    if sets.is_empty() {
        return Err(Error::invalid("this part of the recordings is empty")
            .found(format!("{index} recordings in all")));
    }
    sets.into_iter()
        .map(|(name, recordings)| {
            let warnings = recording_warnings(&recordings);
            let runs = recordings
                .into_iter()
                .map(|recording| {
                    Sample::new(recording.name, recording.trajectory)
                        .map_err(|error| error.at_file(&recording.path))
                })
                .collect::<Result<_>>()?;
            let name = if name.is_empty() {
                UNNAMED.to_owned()
            } else {
                name
            };
            Ok(SetOfRuns {
                name,
                runs,
                warnings,
            })
        })
        .collect()
}
