//! Sets of repeats that have no study: the recordings of one condition, of any robot.

use std::path::Path;

use serde::Serialize;

use super::{NoiseFloor, Sample, Scoring, noise_floor};
use crate::calibration::{Overrides, recording_paths, recording_warnings};
use crate::claim::{self, Claim};
use realgap_core::unit::{Unit, counted};
use realgap_core::{Advice, Error, Result, Warning};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{self, InferredReading, Reading, Recording};

/// Name of the set where no column groups the recordings.
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

/// The recordings of one file, with an inferred reading if the stated one does not suffice.
fn read_file(
    path: &Path,
    reading: &Reading,
    group_column: Option<&str>,
) -> Result<Vec<(String, Recording)>> {
    match trajectory::read_sets(path, reading, group_column) {
        Err(_) if path.is_file() => {
            let inferred = InferredReading::without_questions(path, reading)?;
            trajectory::read_sets(path, &inferred.reading, group_column)
        }
        read => read,
    }
}

/// Reads the recordings that `overrides` names (globs relative to the current folder), in sets: one for each value of
/// `group_column`, in order of first appearance.
///
/// Where no column is named, long-format files with a column `condition` are grouped by it; all others are one set.
/// [`read_sets`](trajectory::read_sets) documents which rows belong together.
///
/// # Errors
/// No recordings, recordings that cannot be read, a column that a file does not have.
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
        for (name, recording) in read_file(&path, &overrides.reading, group_column)? {
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
        .map(|(name, mut recordings)| {
            let mut warnings = recording_warnings(&recordings);
            if overrides.equal_times {
                let mut all: Vec<&mut Recording> = recordings.iter_mut().collect();
                warnings.extend(trajectory::cut_to_shortest(&mut all)?);
            }
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

/// Noise floors of sets of recordings; its `Display` is a text for readers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FloorReport {
    /// Version of this crate.
    pub version: &'static str,
    /// Name and unit of the metrics, in order.
    #[serde(skip)]
    pub metrics: Vec<(&'static str, Unit)>,
    /// One floor a set.
    pub sets: Vec<SetFloor>,
    /// Every claim about reality.
    pub claims: Vec<Claim>,
}

/// The noise floor of one set.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SetFloor {
    /// Name of the set.
    pub set: String,
    /// Its floor, with the warnings of the set.
    #[serde(flatten)]
    pub floor: NoiseFloor,
}

impl FloorReport {
    /// The noise floor of every set.
    ///
    /// # Errors
    /// A metric that cannot compare the recordings, or not a single pair of recordings to compare.
    pub fn new(sets: Vec<SetOfRuns>, scoring: &Scoring, run: &RunOptions<'_>) -> Result<Self> {
        let mut floors = Vec::new();
        for set in sets {
            let mut floor = run.install(|| noise_floor(&set.runs, scoring))??;
            floor.warnings.extend(set.warnings);
            floors.push(SetFloor {
                set: set.name,
                floor,
            });
        }
        if floors.iter().all(|set| set.floor.pairs == 0) {
            let recordings = floors.iter().map(|set| set.floor.recordings).sum();
            return Err(
                Error::invalid("there is no noise floor without repeats of the same run")
                    .field("recordings")
                    .found(counted(recordings, "recording"))
                    .allowed("two or more recordings in a set")
                    .hint("record the same run again, at least five times"),
            );
        }
        let metrics = scoring.metrics.iter().map(|m| (m.name(), m.unit()));
        let metrics: Vec<_> = metrics.collect();
        let first = metrics.first();
        let claim = first.and_then(|first| claim::floor(&floors, *first));
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            metrics,
            sets: floors,
            claims: claim.into_iter().collect(),
        })
    }
}
