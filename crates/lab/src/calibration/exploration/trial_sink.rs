//! Where the trials of a study are stored: in memory, or in the store of a results folder, which then contains a description of
//! the study.

use crate::calibration::{PointScore, Study};
use realgap_core::Result;
use realgap_optimization::Ending;
use realgap_store::{Fingerprint, Memory, Mode, Part, Place, Storage, Store, Trial, TrialScore};

/// A run whose trials are stored, as the store describes it.
pub(in crate::calibration) struct RunDescription<'a> {
    pub study: &'a Study,
    pub fingerprint: Fingerprint,
    /// `sweep` or `tune`.
    pub kind: &'static str,
    /// Trials expected in the end, for messages.
    pub expected: usize,
}

/// Where trials are stored.
pub(in crate::calibration) enum TrialSink<'a> {
    Memory(Memory<Trial>),
    Folder(Box<Store>),
    /// The share of one worker in a distributed run.
    Part(&'a mut Part),
}

impl TrialSink<'_> {
    /// Opens memory, or the store of a folder in the given mode, and writes the description of the run.
    pub fn open(kept: &RunDescription<'_>, place: Option<(Place<'_>, Mode)>) -> Result<Self> {
        let Some((place, mode)) = place else {
            return Ok(Self::Memory(Memory::default()));
        };
        let what = format!("{} of this study", kept.kind);
        let expected = format!("{} points", kept.expected);
        let mut store = Store::open(place, &kept.fingerprint, mode, &what, &expected)?;
        describe(kept, &mut store)?;
        Ok(Self::Folder(Box::new(store)))
    }

    /// The stored trials.
    pub fn rows(&self) -> &dyn Storage<Trial> {
        match self {
            Self::Memory(memory) => memory,
            Self::Folder(store) => &**store,
            Self::Part(part) => &**part,
        }
    }

    /// The store, for writing.
    pub(crate) fn rows_mut(&mut self) -> &mut dyn Storage<Trial> {
        match self {
            Self::Memory(memory) => memory,
            Self::Folder(store) => &mut **store,
            Self::Part(part) => &mut **part,
        }
    }

    /// All trials, by index.
    pub fn trials(&self) -> Result<Vec<Trial>> {
        self.rows().rows_within(0..i64::MAX as usize)
    }

    /// Stores scores beside the trials, for readers of the folder.
    pub fn score(&mut self, points: &[PointScore]) -> Result<()> {
        let Self::Folder(store) = self else {
            return Ok(());
        };
        let scores = points.iter().map(|point| TrialScore {
            index: point.index,
            score: point.score,
            displacement_error_m: point.displacement_error_m,
            recordings: point.recordings.clone(),
        });
        store.insert_scores(&scores.collect::<Vec<_>>())
    }

    /// Stores how the run ended.
    pub fn end(&mut self, ending: Ending) -> Result<()> {
        match self {
            Self::Folder(store) if ending == Ending::Complete => store.complete(),
            _ => Ok(()),
        }
    }
}

/// Writes everything that a reader who has only the store needs to understand it.
fn describe(kept: &RunDescription<'_>, store: &mut Store) -> Result<()> {
    let definition = kept.study.definition();
    let ranges = definition.grid.ranges().iter();
    let list = |names: Vec<&str>| serde_json::json!(names).to_string();
    let recordings = definition.recordings.iter().map(|r| r.name.as_str());
    store.describe([
        ("kind", kept.kind.to_owned()),
        ("study", definition.name.clone()),
        ("study text", definition.text.clone()),
        ("metric", definition.metric.name().to_owned()),
        ("unit", definition.metric.unit().label().to_owned()),
        (
            "parameters",
            list(ranges.clone().map(|r| r.parameter.name).collect()),
        ),
        (
            "parameter units",
            list(ranges.map(|r| r.parameter.unit.label()).collect()),
        ),
        ("recordings", list(recordings.collect())),
    ])
}
