//! What happens to results that are already in a folder.

use std::path::Path;

use super::content::Content;
use super::database::{Store, remove};
use super::fingerprint::Fingerprint;
use super::lock::FolderLock;
use super::row::Table;
use crate::error::{Advice, Error, Result};

/// What to do with results that are already in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Start. Complete results of the same run are used as they are; unfinished ones, and those of any other run, are refused.
    #[default]
    Start,
    /// Go on where an interrupted run of the same kind stopped.
    Resume,
    /// Remove old results first.
    Restart,
}

/// What a store says of how its run ended.
pub(super) const ENDING: &str = "ending";
pub(super) const COMPLETE: &str = "complete";
pub(super) const UNFINISHED: &str = "unfinished";

impl<R: Table> Store<R> {
    /// The store in `folder` as `mode` asks. `what` and `expected` are for the message about an unfinished
    /// run, e.g. `sweep of this study` and `441 points`.
    ///
    /// # Errors
    /// As [`Store::create`] and [`Store::resume`]; an unfinished run that nobody asked to resume or to remove.
    pub fn open(
        folder: &Path,
        fingerprint: &Fingerprint,
        mode: Mode,
        what: &str,
        expected: &str,
    ) -> Result<Self> {
        match mode {
            Mode::Resume => Self::resume(folder, fingerprint),
            Mode::Restart => {
                let lock = FolderLock::make(folder)?;
                remove(folder)?;
                let (store, _) = Self::find(folder, lock)?;
                store.set_up(fingerprint)
            }
            Mode::Start => Self::start(folder, fingerprint, what, expected),
        }
    }

    fn start(folder: &Path, fingerprint: &Fingerprint, what: &str, expected: &str) -> Result<Self> {
        let lock = FolderLock::make(folder)?;
        let (mut store, content) = Self::find(folder, lock)?;
        if matches!(content, Content::Nothing) {
            return store.set_up(fingerprint);
        }
        store.verify_all()?;
        let count = store.finished()?.len();
        if store.is_complete()? {
            store.must_be_of(fingerprint)?;
            return Ok(store);
        }
        if count == 0 {
            // Stopped before its first result: nothing is lost.
            return store.anew(folder, fingerprint);
        }
        store.must_be_of(fingerprint)?;
        Err(
            Error::conflict(format!("the folder holds an unfinished {what}"))
                .at_file(folder)
                .found(format!("{count} of {expected}"))
                .advise(Advice::Resume)
                .advise(Advice::OtherFolder),
        )
    }

    /// Marks the run as complete.
    ///
    /// # Errors
    /// A store that cannot be written.
    pub fn complete(&mut self) -> Result<()> {
        self.describe([(ENDING, COMPLETE.to_owned())])
    }
}
