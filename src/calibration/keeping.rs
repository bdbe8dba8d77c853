//! How a study's results are kept: opening the store, explaining it, marking its end.

use std::path::Path;

use super::score::PointScore;
use super::study::Study;
use crate::error::Result;
use crate::optimization::Ending;
use crate::store::{Fingerprint, Mode, Store, TrialScore};

/// One run that keeps its results.
pub(super) struct Keeping<'a> {
    pub study: &'a Study,
    pub fingerprint: Fingerprint,
    /// `sweep` or `tune`.
    pub kind: &'static str,
    /// Trials expected in the end, for messages.
    pub expected: usize,
}

impl Keeping<'_> {
    /// The store in `folder`, described.
    pub fn open(&self, folder: &Path, mode: Mode) -> Result<Store> {
        let what = format!("{} of this study", self.kind);
        let expected = format!("{} points", self.expected);
        let mut store = Store::open(folder, &self.fingerprint, mode, &what, &expected)?;
        self.describe(&mut store)?;
        Ok(store)
    }

    /// What somebody with nothing but the store needs to read it.
    fn describe(&self, store: &mut Store) -> Result<()> {
        let definition = self.study.definition();
        let ranges = definition.grid.ranges().iter();
        let list = |names: Vec<&str>| serde_json::json!(names).to_string();
        store.describe([
            ("kind", self.kind.to_owned()),
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
            (
                "recordings",
                list(
                    definition
                        .recordings
                        .iter()
                        .map(|r| r.name.as_str())
                        .collect(),
                ),
            ),
        ])
    }

    /// Keeps scores beside the trials.
    pub fn score(&self, store: &mut Store, points: &[PointScore]) -> Result<()> {
        let scores: Vec<TrialScore> = points
            .iter()
            .map(|point| TrialScore {
                index: point.index,
                score: point.score,
                displacement_error_m: point.displacement_error_m,
                recordings: point.recordings.clone(),
            })
            .collect();
        store.insert_scores(&scores)
    }

    /// Notes how the run ended.
    pub fn end(&self, store: &mut Store, ending: Ending) -> Result<()> {
        if ending == Ending::Complete {
            store.complete()?;
        }
        Ok(())
    }
}
