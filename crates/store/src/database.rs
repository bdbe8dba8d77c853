//! The store of one run's results: an SQLite file in a results folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, Transaction, params};

use super::checksum::Tally;
use super::connection::{DAMAGED_HINT, merge_log, set_change_counter, sql, with_suffix};
use super::content::{Content, LAYOUT, content};
use super::count::{self, Count};
use super::description::{
    ASKED, COMPLETE, ENDING, UNFINISHED, entries, entry_checksum, put_description,
};
use super::fingerprint::Fingerprint;
use super::lock::{FolderLock, Place};
use super::row::Table;
use super::storage::Storage;
use super::trial::Trial;
use realgap_core::error::{Advice, Error, Result};

/// Name of the store inside a results folder.
pub const STORE_FILE: &str = "results.sqlite";

/// Removes the store in a locked folder, if there is one.
pub(super) fn remove(folder: &Path) -> Result<()> {
    let path = folder.join(STORE_FILE);
    for suffix in [
        "",
        "-wal",
        "-shm",
        "-journal",
        count::COUNT,
        count::SET_ASIDE,
    ] {
        let path = with_suffix(&path, suffix);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(Error::io("remove old results", &path, &e));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The tables of every store. `tally` holds the number of rows in all tables and their combined checksum.
const COMMON_TABLES: &str = "
    CREATE TABLE description (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
    CREATE TABLE fingerprint (position INTEGER PRIMARY KEY, name TEXT NOT NULL, value TEXT NOT NULL) STRICT;
    CREATE TABLE tally (rows INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT;
    INSERT INTO tally VALUES (0, 0);";

/// Queries for the named texts of a store, and for the entries of its fingerprint in their order.
const DESCRIPTION: &str = "SELECT name, value FROM description";
const FINGERPRINT: &str = "SELECT name, value FROM fingerprint ORDER BY position";

/// The number of rows that are read and verified at a time.
const VERIFIED_AT_ONCE: usize = 256;

/// The results of one run as rows of one kind: [`Trial`]s of a study, or [`RobotRow`](super::RobotRow)s of a search. A store is open
/// either for writing by this process only, or for reading.
#[derive(Debug)]
pub struct Store<R = Trial> {
    pub(super) connection: Connection,
    pub(super) path: PathBuf,
    pub(super) tally: Tally,
    pub(super) is_marked_complete: bool,
    pub(super) writer: Option<Writer>,
    pub(super) rows: PhantomData<R>,
}

/// The parts of a store that is open for writing.
#[derive(Debug)]
pub(super) struct Writer {
    pub count: Count,
    /// Held until the store is closed.
    #[expect(dead_code, reason = "held, not used")]
    pub lock: FolderLock,
}

impl<R> Store<R> {
    /// The tally of the description and fingerprint entries, computed from their present texts.
    fn common_checksums(&self) -> rusqlite::Result<Tally> {
        let mut tally = Tally::default();
        for (table, query) in [("description", DESCRIPTION), ("fingerprint", FINGERPRINT)] {
            for (name, value) in entries(&self.connection, query)? {
                tally.add(entry_checksum(table, &name, &value));
            }
        }
        Ok(tally)
    }

    pub(super) fn damaged(&self, what: impl std::fmt::Display) -> Error {
        Error::conflict("the results are damaged")
            .at_file(&self.path)
            .found(what)
            .allowed("exactly the bytes that were written")
            .hint(DAMAGED_HINT)
            .advise(Advice::OtherFolder)
    }

    /// The fingerprint that the store was created with.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn fingerprint(&self) -> Result<Fingerprint> {
        self.texts(FINGERPRINT)
    }

    /// The named texts that [`Store::describe`] stored.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn description(&self) -> Result<BTreeMap<String, String>> {
        self.texts(DESCRIPTION)
    }

    fn texts<T: FromIterator<(String, String)>>(&self, query: &str) -> Result<T> {
        let entries = entries(&self.connection, query);
        let entries = entries.map_err(|e| sql(&self.path, "read the results", &e))?;
        Ok(entries.into_iter().collect())
    }

    /// Stores named texts that describe the rows, so that the store can be read without other files; old values are replaced.
    ///
    /// # Errors
    /// A full disk or a store that cannot be written.
    pub fn describe<'a>(
        &mut self,
        entries: impl IntoIterator<Item = (&'a str, String)>,
    ) -> Result<()> {
        self.write("write the results", |transaction, tally| {
            for (name, value) in entries {
                put_description(transaction, tally, name, &value)?;
            }
            Ok(())
        })?;
        self.is_marked_complete = self.is_complete()?;
        Ok(())
    }

    /// True if the run is complete.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn is_complete(&self) -> Result<bool> {
        let described = self.description()?;
        Ok(described.get(ENDING).is_some_and(|e| e == COMPLETE))
    }

    /// The number of rows that the run will have at the end of its present batch; `None` if unknown.
    pub(super) fn asked(&self) -> Option<usize> {
        self.description().ok()?.get(ASKED)?.parse().ok()
    }

    /// Writes in one transaction, either everything or nothing.
    pub(super) fn write(
        &mut self,
        doing: &str,
        write: impl FnOnce(&Transaction<'_>, &mut Tally) -> rusqlite::Result<()>,
    ) -> Result<()> {
        let path = self.path.clone();
        let fail = |e: rusqlite::Error| sql(&path, doing, &e);
        let mut tally = self.tally;
        let transaction = self.connection.transaction().map_err(fail)?;
        write(&transaction, &mut tally).map_err(fail)?;
        commit(transaction, self.writer.as_mut(), [self.tally, tally], fail)?;
        self.tally = tally;
        Ok(())
    }
}

impl<R: Table> Store<R> {
    /// Creates a new store in `folder`, which is created if it is missing.
    ///
    /// # Errors
    /// A folder that cannot be created or written, is in use, or already holds results.
    pub fn create(folder: &Path, fingerprint: &Fingerprint) -> Result<Self> {
        match Self::find(FolderLock::make(folder)?, None)? {
            (store, Content::Nothing) => store.set_up(fingerprint),
            (store, Content::Tables) => Err(Error::conflict("the folder already holds results")
                .at_file(&store.path)
                .advise(Advice::Resume)
                .advise(Advice::OtherFolder)),
        }
    }

    /// Opens the store in `folder` to continue its run; a new store if the run was killed before it had created one.
    ///
    /// # Errors
    /// No store in the folder, a damaged store, a store of another study or search (the error names the difference), or a folder in use.
    /// Rows of a killed run that were lost are no error: they are computed again.
    pub fn resume<'a>(place: impl Into<Place<'a>>, fingerprint: &Fingerprint) -> Result<Self> {
        let lock = place.into().lock()?;
        if !lock.folder().join(STORE_FILE).exists() && !lock.is_known() {
            return Err(Error::conflict("there is nothing to resume")
                .at_file(lock.folder())
                .hint("start the run first"));
        }
        Self::go_on(lock, fingerprint)
    }

    /// Opens the store in a locked folder to continue its run; a new store if there is none.
    pub(super) fn go_on(lock: FolderLock, fingerprint: &Fingerprint) -> Result<Self> {
        match Self::find(lock, Some(fingerprint))? {
            (store, Content::Nothing) => store.set_up(fingerprint),
            (store, Content::Tables) => {
                store.must_be_of(fingerprint)?;
                Ok(store)
            }
        }
    }

    /// Opens the store in `folder` for reading; another process may write into it at the same time.
    ///
    /// # Errors
    /// No readable store of such rows in the folder, or a damaged one.
    pub fn read(folder: &Path) -> Result<Self> {
        let mut store = Self::look(folder)?;
        store.tally = store.verified()?;
        Ok(store)
    }

    /// True if the store in `folder` has rows of this kind.
    ///
    /// # Errors
    /// No readable store in the folder.
    pub fn is_in(folder: &Path) -> Result<bool> {
        let store = Self::file(folder)?;
        Ok(match content(&store.connection, &store.path)? {
            Content::Tables => store.has_rows()?,
            Content::Nothing => false,
        })
    }

    /// As [`Store::read`], without verifying every row, for callers that only need the progress of a run.
    ///
    /// # Errors
    /// The same as of [`Store::read`].
    pub fn look(folder: &Path) -> Result<Self> {
        let store = Self::file(folder)?;
        match content(&store.connection, &store.path)? {
            Content::Tables => {
                store.must_have_rows()?;
                Ok(store)
            }
            Content::Nothing => Err(Error::invalid("no results here")
                .at_file(&store.path)
                .hint("a run was stopped before its first result")),
        }
    }

    pub(super) fn has_rows(&self) -> Result<bool> {
        self.connection
            .query_row(
                "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = ?1",
                [R::NAME],
                |row| Ok(row.get::<_, i64>(0)? == 1),
            )
            .map_err(|e| sql(&self.path, "read the results", &e))
    }

    pub(super) fn must_have_rows(&self) -> Result<()> {
        if self.has_rows()? {
            return Ok(());
        }
        Err(Error::conflict("the folder holds results of another kind")
            .at_file(&self.path)
            .allowed(format!("a store of rows `{}`", R::NAME))
            .advise(Advice::OtherFolder))
    }

    pub(super) fn set_up(mut self, fingerprint: &Fingerprint) -> Result<Self> {
        self.write("set up the results", |transaction, tally| {
            transaction.execute_batch(COMMON_TABLES)?;
            transaction.execute_batch(R::TABLES)?;
            for (position, (name, value)) in fingerprint.entries().iter().enumerate() {
                transaction.execute(
                    "INSERT INTO fingerprint VALUES (?1, ?2, ?3)",
                    params![position as i64, name, value],
                )?;
                tally.add(entry_checksum("fingerprint", name, value));
            }
            transaction.pragma_update(None, "user_version", LAYOUT)
        })?;
        Ok(self)
    }

    /// Replaces this store, which has no rows, by a new one.
    pub(super) fn replace_empty(self, lock: FolderLock, fingerprint: &Fingerprint) -> Result<Self> {
        drop(self);
        remove(lock.folder())?;
        let (store, _) = Self::find(lock, None)?;
        store.set_up(fingerprint)
    }

    pub(super) fn must_be_of(&self, fingerprint: &Fingerprint) -> Result<()> {
        fingerprint
            .must_equal(&self.fingerprint()?)
            .map_err(|error| error.at_file(&self.path))
    }

    /// Verifies every row of every table against its checksum, and returns the tally of the store.
    ///
    /// # Errors
    /// A row that was changed, is missing or occurs twice.
    pub(super) fn verified(&self) -> Result<Tally> {
        let verified = self.each_verified(|_, _| Ok(()));
        verified.map_err(|error| match count::has_log(&self.path) {
            // If the log is of another run, the store may be intact without it.
            true => error.without_advice().advise(Advice::Resume),
            false => error,
        })
    }

    /// Calls `each` with every row and its checksum, by index, and verifies all rows against the tally of the store.
    ///
    /// # Errors
    /// A row that was changed, is missing or occurs twice; errors of `each`.
    pub(super) fn each_verified(
        &self,
        mut each: impl FnMut(R, i64) -> Result<()>,
    ) -> Result<Tally> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        // The transaction gives a consistent snapshot, even if another process writes meanwhile.
        let snapshot = self.connection.unchecked_transaction().map_err(fail)?;
        let mut tally = self.common_checksums().map_err(fail)?;
        let ids: Vec<usize> = self.finished()?.into_iter().collect();
        for some in ids.chunks(VERIFIED_AT_ONCE) {
            let (Some(&first), Some(&last)) = (some.first(), some.last()) else {
                continue;
            };
            for (row, checksum) in self.checked(first as i64, last as i64 + 1)? {
                tally.add(checksum);
                each(row, checksum)?;
            }
        }
        for checksum in R::more_checksums(&snapshot).map_err(fail)? {
            match checksum {
                (stored, computed) if stored == computed => tally.add(stored),
                _ => return Err(self.damaged("a score that has changed")),
            }
        }
        let stored: Vec<Tally> = snapshot
            .prepare("SELECT rows, checksum FROM tally")
            .and_then(|mut statement| {
                let rows = statement.query_map([], |row| {
                    Ok(Tally {
                        rows: row.get(0)?,
                        checksum: row.get(1)?,
                    })
                })?;
                rows.collect()
            })
            .map_err(fail)?;
        if stored != [tally] {
            return Err(self.damaged("missing rows, or rows that realgap has not written"));
        }
        Ok(tally)
    }

    fn checked(&self, from: i64, to: i64) -> Result<Vec<(R, i64)>> {
        let rows = R::read(&self.connection, from, to)
            .map_err(|e| sql(&self.path, "read the results", &e))?;
        rows.into_iter()
            .map(|checked| {
                if checked.stored == checked.computed {
                    return Ok((checked.row, checked.stored));
                }
                let index = checked.row.index();
                Err(self.damaged(format!("{} {index} has changed", R::NAME)))
            })
            .collect()
    }

    /// Stores rows, either all of them or none.
    ///
    /// # Errors
    /// A full disk or a row that is already stored.
    pub fn insert(&mut self, rows: &[R]) -> Result<()> {
        if rows.is_empty() {
            return Ok(());
        }
        let was_complete = self.is_marked_complete;
        self.write("write results", |transaction, tally| {
            for row in rows {
                tally.add(row.insert(transaction)?);
            }
            if was_complete {
                // The run has more rows than when it was marked as complete.
                put_description(transaction, tally, ENDING, UNFINISHED)?;
            }
            Ok(())
        })?;
        self.is_marked_complete = false;
        Ok(())
    }

    /// Indices of the stored rows.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn finished(&self) -> Result<BTreeSet<usize>> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare(&format!("SELECT id FROM {}", R::NAME))
            .map_err(fail)?;
        let rows = statement
            .query_map([], |row| row.get::<_, i64>(0))
            .map_err(fail)?;
        rows.map(|row| row.map(|id| id as usize))
            .collect::<rusqlite::Result<_>>()
            .map_err(fail)
    }

    /// All rows, sorted by index.
    ///
    /// # Errors
    /// A store that cannot be read, or a row that was changed.
    pub fn rows(&self) -> Result<Vec<R>> {
        self.rows_within(0..i64::MAX as usize)
    }

    /// The rows with an index in `range`, sorted by index.
    ///
    /// # Errors
    /// The same as of [`Store::rows`].
    pub fn rows_within(&self, range: std::ops::Range<usize>) -> Result<Vec<R>> {
        let rows = self.checked(range.start as i64, range.end as i64)?;
        Ok(rows.into_iter().map(|(row, _)| row).collect())
    }
}

impl<R: Table> Storage<R> for Store<R> {
    fn finished(&self) -> Result<BTreeSet<usize>> {
        self.finished()
    }

    fn insert(&mut self, rows: &[R]) -> Result<()> {
        self.insert(rows)
    }

    fn rows_within(&self, range: std::ops::Range<usize>) -> Result<Vec<R>> {
        self.rows_within(range)
    }

    /// Stores the number of rows, so that a reader can report the progress meanwhile.
    fn begin(&mut self, rows: usize) {
        if self.asked().is_none_or(|asked| asked < rows) {
            // An error is ignored, because a full disk is reported with the first row.
            let _unwritten = self.describe([(ASKED, rows.to_string())]);
        }
    }
}

impl<R> Drop for Store<R> {
    fn drop(&mut self) {
        let Some(writer) = &self.writer else {
            return;
        };
        if merge_log(&self.connection) {
            writer.count.remove();
        }
        if self.is_marked_complete
            && let Ok(nothing) = Connection::open_in_memory()
        {
            drop(std::mem::replace(&mut self.connection, nothing));
            set_change_counter(&self.path, self.tally.checksum as u32);
        }
    }
}

/// Commits a transaction that changes a store's tally from the first to the second, and notes the tally in the store and in the file
/// beside it.
///
/// # Errors
/// A full disk.
pub(super) fn commit(
    transaction: Transaction<'_>,
    writer: Option<&mut Writer>,
    [before, after]: [Tally; 2],
    fail: impl Fn(rusqlite::Error) -> Error,
) -> Result<()> {
    transaction
        .prepare_cached("UPDATE tally SET rows = ?1, checksum = ?2")
        .and_then(|mut update| update.execute([after.rows, after.checksum]))
        .map_err(&fail)?;
    let Some(writer) = writer else {
        return transaction.commit().map_err(fail);
    };
    writer.count.note([before, after])?;
    transaction.commit().map_err(fail)?;
    writer.count.note([after; 2])
}
