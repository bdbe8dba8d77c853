//! Opens a store in a folder that may already hold results: start, resume or restart.

use std::marker::PhantomData;
use std::path::Path;

use super::checksum::Tally;
use super::connection::{connect, connect_to_read, take_back};
use super::content::{Content, content, is_foreign};
use super::count::{self, Count};
use super::database::{STORE_FILE, Store, Writer, remove};
use super::description::{COMPLETE, ENDING};
use super::file_system::FileSystem;
use super::fingerprint::Fingerprint;
use super::journal::{Journal, journal_of};
use super::lock::{FolderLock, Place};
use super::log::verify_log;
use super::row::Table;
use realgap_core::error::{Advice, Error, Result};

/// What to do with results that are already in the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Start a run. Complete results of the same run are used as they are; unfinished results, and results of any other run, are refused.
    #[default]
    Start,
    /// Continue an interrupted run of the same study or search.
    Resume,
    /// Remove the old results first.
    Restart,
}

impl<R: Table> Store<R> {
    /// Opens the store in a folder as `mode` says. `what` and `expected` are used in the error message about an unfinished
    /// run, e.g. `sweep of this study` and `441 points`.
    ///
    /// # Errors
    /// The errors of [`Store::create`] and [`Store::resume`]; an unfinished run if `mode` is [`Mode::Start`].
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
                    return Err(Error::conflict(
                        "this file is not a store of results, so it is not removed",
                    )
                    .at_file(&old)
                    .advise(Advice::OtherFolder));
                }
                remove(lock.folder())?;
                let (store, _) = Self::find(lock, None)?;
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
        let (store, content) = Self::find(lock.clone(), None)?;
        if matches!(content, Content::Nothing) {
            return store.set_up(fingerprint);
        }
        let count = store.finished()?.len();
        if store.is_complete()? {
            store.must_be_of(fingerprint)?;
            return Ok(store);
        }
        if count == 0 {
            // The run was stopped before its first result, so no result is lost.
            return store.replace_empty(lock, fingerprint);
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

    /// Marks the run as complete, and compacts the file: equal results then give equal bytes, in whichever order they were stored.
    ///
    /// # Errors
    /// A store that cannot be written.
    pub fn complete(&mut self) -> Result<()> {
        self.describe([(ENDING, COMPLETE.to_owned())])?;
        // An error is ignored: without disk space for compaction, the results are still complete.
        let _unpacked = self.connection.execute_batch("VACUUM");
        Ok(())
    }

    /// Opens the store's file in `folder` for reading, without a check of its kind.
    pub(super) fn file(folder: &Path) -> Result<Self> {
        let path = folder.join(STORE_FILE);
        let is_held = || FolderLock::is_held(folder);
        if !path.exists() {
            return Err(match count::difference(&path, None)? {
                Some(found) if !is_held() => count::mismatch_error(&path, found),
                _ => Error::invalid("no results here")
                    .at_file(&path)
                    .hint("give a folder that a sweep, a tuning or a search has written"),
            });
        }
        let was_held = is_held();
        if !was_held {
            check_log(&path)?;
        }
        let store = Self::of_file(&path)?;
        // A process that starts to write meanwhile may have noted more rows than this connection sees.
        if !was_held
            && let Some(found) = count::difference(&path, Some(&store.connection))?
            && !is_held()
        {
            return Err(count::mismatch_error(&path, found));
        }
        Ok(store)
    }

    /// Opens a file for reading, after what a killed process has written halfway was taken back. Only the file system is checked.
    fn of_file(path: &Path) -> Result<Self> {
        if count::is_logged(path)?
            && let Some(folder) = path.parent()
        {
            FileSystem::of(folder).must_share_memory(path)?;
        }
        // A damaged journal is only used by a run that goes on, which makes lost rows anew.
        if journal_of(path)? == Journal::Whole {
            // Where this is refused, as in a folder that cannot be written, reading says why.
            let _refused = take_back(path);
        }
        Ok(Self {
            connection: connect_to_read(path)?,
            path: path.to_path_buf(),
            tally: Tally::default(),
            is_marked_complete: false,
            writer: None,
            rows: PhantomData,
        })
    }

    /// Opens the file in a locked folder for writing, after its content was verified, and says whether it holds any tables. If a run with
    /// the fingerprint `resumed` is continued, a store that lost its last rows is accepted.
    pub(super) fn find(lock: FolderLock, resumed: Option<&Fingerprint>) -> Result<(Self, Content)> {
        let path = lock.folder().join(STORE_FILE);
        // The checks come before any writing, so that a refused store stays unchanged.
        match resumed {
            Some(fingerprint) => Self::repair(&path, fingerprint)?,
            None if path.exists() => check_log(&path)?,
            None => {}
        }
        let (mut found, mut store) = (Content::Nothing, None);
        if path.exists() {
            let there = Self::of_file(&path)?;
            found = content(&there.connection, &path)?;
            store = Some(there);
        }
        let connection = store.as_ref().map(|store| &store.connection);
        if resumed.is_none()
            && let Some(found) = count::difference(&path, connection)?
        {
            return Err(count::mismatch_error(&path, found));
        }
        let mut tally = Tally::default();
        if let (Content::Tables, Some(store)) = (&found, store) {
            store.must_have_rows()?;
            tally = store.verified()?;
        }
        let count = Count::open(&path, tally)?;
        let mut store = Self {
            connection: connect(&path, lock.file_system())?,
            path,
            tally,
            is_marked_complete: false,
            writer: Some(Writer { count, lock }),
            rows: PhantomData,
        };
        if matches!(found, Content::Tables) {
            store.is_marked_complete = store.is_complete()?;
        }
        Ok((store, found))
    }

    /// Moves a write-ahead log aside if it does not belong to this store, or if the store is inconsistent with it; the rows in the main
    /// file remain.
    fn repair(path: &Path, fingerprint: &Fingerprint) -> Result<()> {
        if count::has_foreign_log(path)? {
            return count::set_log_aside(path);
        }
        if !path.exists() {
            return Ok(());
        }
        take_back(path)?;
        if !count::has_log(path) {
            return Ok(());
        }
        let is_whole = |store: &Self| -> Result<bool> {
            if matches!(content(&store.connection, path)?, Content::Nothing) {
                return Ok(count::difference(path, Some(&store.connection))?.is_none());
            }
            if !store.has_rows()? || store.each_verified(|_, _| Ok(())).is_err() {
                return Ok(false);
            }
            // Consistent results of another run are refused later, so their log is kept.
            Ok(store.must_be_of(fingerprint).is_ok()
                || count::difference(path, Some(&store.connection))?.is_none())
        };
        let is_to_be_kept = Self::of_file(path).and_then(|store| is_whole(&store));
        match is_to_be_kept {
            Ok(true) => Ok(()),
            _ => count::set_log_aside(path),
        }
    }
}

/// Checks the write-ahead log beside a store that no process writes into.
fn check_log(path: &Path) -> Result<()> {
    if count::has_foreign_log(path)? {
        return Err(count::foreign_log(path));
    }
    verify_log(path)
}
