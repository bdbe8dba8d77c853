//! How a study's results are kept: opening the store, explaining it, marking its end.

use std::path::Path;

use super::problem::Problem;
use super::score::PointScore;
use crate::error::{Error, Result};
use crate::store::{Fingerprint, STORE_FILE, Store, TrialScore};
use crate::tuning::Ending;

/// What to do with results that are already in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Start; results of the same study that are complete are made again, any others are refused.
    #[default]
    Start,
    /// Go on where an interrupted run of the same study stopped.
    Resume,
    /// Remove old results first.
    Restart,
}

/// One run that keeps its results.
pub(super) struct Keeping<'a> {
    pub problem: &'a Problem,
    pub fingerprint: Fingerprint,
    /// `sweep` or `tune`.
    pub kind: &'static str,
    /// Trials expected in the end, for messages.
    pub expected: usize,
}

/// What a finished store says of itself.
const ENDING: &str = "ending";
const COMPLETE: &str = "complete";

impl Keeping<'_> {
    /// The store in `folder`, described.
    pub fn open(&self, folder: &Path, mode: Mode) -> Result<Store> {
        let mut store = match mode {
            Mode::Resume => Store::resume(folder, &self.fingerprint)?,
            Mode::Restart => {
                Store::remove(folder)?;
                Store::create(folder, &self.fingerprint)?
            }
            Mode::Start => {
                if folder.join(STORE_FILE).exists() {
                    self.must_be_complete(folder)?;
                    // Complete and of the same study: made again, the same bits will come out.
                    Store::remove(folder)?;
                }
                Store::create(folder, &self.fingerprint)?
            }
        };
        self.describe(&mut store)?;
        Ok(store)
    }

    fn must_be_complete(&self, folder: &Path) -> Result<()> {
        let old = Store::resume(folder, &self.fingerprint)?;
        if old
            .description()?
            .get(ENDING)
            .is_some_and(|e| e == COMPLETE)
        {
            return Ok(());
        }
        Err(Error::conflict(format!(
            "the folder holds an unfinished {} of this study",
            self.kind
        ))
        .at_file(folder)
        .found(format!(
            "{} of {} points",
            old.finished()?.len(),
            self.expected
        ))
        .hint("go on with --resume, start anew with --restart, or choose another folder with -o"))
    }

    /// What somebody with nothing but the store needs to read it.
    fn describe(&self, store: &mut Store) -> Result<()> {
        let study = self.problem.study();
        let ranges = study.grid.ranges().iter();
        let list = |names: Vec<&str>| serde_json::json!(names).to_string();
        store.describe([
            ("kind", self.kind.to_owned()),
            ("study", study.name.clone()),
            ("study text", study.text.clone()),
            ("metric", study.metric.name().to_owned()),
            ("unit", study.metric.unit().label().to_owned()),
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
                list(study.recordings.iter().map(|r| r.name.as_str()).collect()),
            ),
            (ENDING, "unfinished".to_owned()),
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
            store.describe([(ENDING, COMPLETE.to_owned())])?;
        }
        Ok(())
    }
}
