//! What happens to results that are already in a folder.

use super::content::{Content, is_foreign};
use super::database::{STORE_FILE, Store, remove};
use super::description::{COMPLETE, ENDING};
use super::fingerprint::Fingerprint;
use super::lock::{FolderLock, Place};
use super::row::Table;
use realgap_core::error::{Advice, Error, Result};

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

impl<R: Table> Store<R> {
    /// The store in a folder as `mode` asks. `what` and `expected` are for the message about an unfinished
    /// run, e.g. `sweep of this study` and `441 points`.
    ///
    /// # Errors
    /// As [`Store::create`] and [`Store::resume`]; an unfinished run that nobody asked to resume or to remove.
    pub fn open<'a>(
        place: impl Into<Place<'a>>,
        fingerprint: &Fingerprint,
        mode: Mode,
        what: &str,
        expected: &str,
    ) -> Result<Self> {
        let lock = place.into().lock()?;
        match mode {
            Mode::Resume => Self::resume(&lock, fingerprint),
            Mode::Restart => {
                let old = lock.folder().join(STORE_FILE);
                if is_foreign(&old, lock.is_known()) {
                    return Err(Error::conflict("this is no store of results, and stays")
                        .at_file(&old)
                        .advise(Advice::OtherFolder));
                }
                remove(lock.folder())?;
                let (store, _) = Self::find(lock)?;
                store.set_up(fingerprint)
            }
            Mode::Start => Self::start(lock, fingerprint, what, expected),
        }
    }

    fn start(
        lock: FolderLock,
        fingerprint: &Fingerprint,
        what: &str,
        expected: &str,
    ) -> Result<Self> {
        let (mut store, content) = Self::find(lock.clone())?;
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
            return store.anew(lock, fingerprint);
        }
        store.must_be_of(fingerprint)?;
        Err(
            Error::conflict(format!("the folder holds an unfinished {what}"))
                .at_file(lock.folder())
                .found(format!("{count} of {expected}"))
                .advise(Advice::Resume)
                .advise(Advice::OtherFolder),
        )
    }

    /// Marks the run as complete, and packs the file: equal results are then equal bytes, whatever the order in which they came.
    ///
    /// # Errors
    /// A store that cannot be written.
    pub fn complete(&mut self) -> Result<()> {
        self.describe([(ENDING, COMPLETE.to_owned())])?;
        // Best effort: nothing is lost where there is no room for it.
        let _unpacked = self.connection.execute_batch("VACUUM");
        Ok(())
    }
}
