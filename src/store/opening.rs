//! What happens to results that are already in a folder.

use std::path::Path;

use super::database::{STORE_FILE, Store};
use super::fingerprint::Fingerprint;
use crate::error::{Advice, Error, Result};

/// What to do with results that are already in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Start; results of the same run that are complete are made again, any others are refused.
    #[default]
    Start,
    /// Go on where an interrupted run of the same kind stopped.
    Resume,
    /// Remove old results first.
    Restart,
}

/// What a store says of how its run ended.
const ENDING: &str = "ending";
const COMPLETE: &str = "complete";

impl Store {
    /// The store in `folder` as `mode` asks, marked unfinished. `what` and `expected` are for the message about an unfinished
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
        let mut store = match mode {
            Mode::Resume => Self::resume(folder, fingerprint)?,
            Mode::Restart => {
                Self::remove(folder)?;
                Self::create(folder, fingerprint)?
            }
            Mode::Start => {
                if folder.join(STORE_FILE).exists() {
                    let old = Self::resume(folder, fingerprint)?;
                    if !old.is_complete()? {
                        return Err(Error::conflict(format!(
                            "the folder holds an unfinished {what}"
                        ))
                        .at_file(folder)
                        .found(format!("{} of {expected}", old.finished()?.len()))
                        .advise(Advice::Resume)
                        .advise(Advice::Restart)
                        .advise(Advice::OtherFolder));
                    }
                    // Complete and of the same run: made again, the same bits will come out.
                    drop(old);
                    Self::remove(folder)?;
                }
                Self::create(folder, fingerprint)?
            }
        };
        store.describe([(ENDING, "unfinished".to_owned())])?;
        Ok(store)
    }

    /// Marks the run as complete.
    ///
    /// # Errors
    /// A store that cannot be written.
    pub fn complete(&mut self) -> Result<()> {
        self.describe([(ENDING, COMPLETE.to_owned())])
    }

    /// Whether the run came to its end.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn is_complete(&self) -> Result<bool> {
        Ok(self
            .description()?
            .get(ENDING)
            .is_some_and(|ending| ending == COMPLETE))
    }
}
