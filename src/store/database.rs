//! The SQLite file of a results folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, OptionalExtension, params};

use super::fingerprint::Fingerprint;
use super::lock::FolderLock;
use super::trial::{Outcome, OutcomeStatus, Trial, TrialScore};
use crate::error::{Advice, Error, Result};

/// Name of the store inside a results folder.
pub const STORE_FILE: &str = "results.sqlite";

/// Layout of the tables; raised when they change.
const SCHEMA: i64 = 2;

/// The results of one study, open for writing by this process alone.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    path: PathBuf,
    _lock: Option<FolderLock>,
}

impl Store {
    /// A new store in `folder` (made if absent).
    ///
    /// # Errors
    /// A folder that cannot be made or written, is in use, or already holds results.
    pub fn create(folder: &Path, fingerprint: &Fingerprint) -> Result<Self> {
        let lock = lock(folder)?;
        let path = folder.join(STORE_FILE);
        if path.exists() {
            return Err(Error::conflict("the folder already holds results")
                .at_file(&path)
                .advise(Advice::Resume)
                .advise(Advice::Restart)
                .advise(Advice::OtherFolder));
        }
        let mut store = Self {
            connection: connect(&path)?,
            path,
            _lock: Some(lock),
        };
        store.set_up(fingerprint)?;
        Ok(store)
    }

    /// The store in `folder`, to go on with it.
    ///
    /// # Errors
    /// No store there, a store of another study (the difference is named), or a folder in use.
    pub fn resume(folder: &Path, fingerprint: &Fingerprint) -> Result<Self> {
        let path = folder.join(STORE_FILE);
        if !path.exists() {
            return Err(Error::conflict("there is nothing to resume")
                .at_file(&path)
                .hint("run it once before"));
        }
        let lock = lock(folder)?;
        let store = Self {
            connection: connect(&path)?,
            path,
            _lock: Some(lock),
        };
        store.check_schema()?;
        fingerprint
            .must_equal(&store.fingerprint()?)
            .map_err(|error| error.at_file(&store.path))?;
        Ok(store)
    }

    /// Removes the store in `folder`, if there is one, so that a new one can be created.
    ///
    /// # Errors
    /// A folder in use, or files that cannot be removed.
    pub fn remove(folder: &Path) -> Result<()> {
        let _lock = lock(folder)?;
        for suffix in ["", "-wal", "-shm"] {
            let path = folder.join(format!("{STORE_FILE}{suffix}"));
            match fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::io("remove old results", &path, &e));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The store in `folder`, for reading; a writer may be at work at the same time.
    ///
    /// # Errors
    /// No readable store there.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(STORE_FILE);
        if !path.exists() {
            return Err(Error::invalid("no results here")
                .at_file(&path)
                .hint("name a folder that a sweep has written"));
        }
        let connection = Connection::open_with_flags(&path, OpenFlags::SQLITE_OPEN_READ_WRITE)
            .map_err(|e| sql(&path, "open the results", &e))?;
        let store = Self {
            connection,
            path,
            _lock: None,
        };
        store.check_schema()?;
        Ok(store)
    }

    fn set_up(&mut self, fingerprint: &Fingerprint) -> Result<()> {
        let path = self.path.clone();
        let fail = |e: rusqlite::Error| sql(&path, "set up the results", &e);
        let transaction = self.connection.transaction().map_err(fail)?;
        transaction
            .execute_batch(
                "CREATE TABLE description (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
                 CREATE TABLE score (trial INTEGER PRIMARY KEY REFERENCES trial, score REAL,
                    displacement_error_m REAL, recordings BLOB NOT NULL) STRICT;
                 CREATE TABLE fingerprint (position INTEGER PRIMARY KEY, name TEXT NOT NULL, value TEXT NOT NULL) STRICT;
                 CREATE TABLE trial (id INTEGER PRIMARY KEY, parameters BLOB NOT NULL) STRICT;
                 CREATE TABLE outcome (
                    trial INTEGER NOT NULL REFERENCES trial, position INTEGER NOT NULL,
                    diverged TEXT, steps INTEGER NOT NULL, net_displacement_m REAL,
                    scores BLOB NOT NULL, path_xy_m BLOB NOT NULL,
                    PRIMARY KEY (trial, position)) STRICT, WITHOUT ROWID;",
            )
            .map_err(fail)?;
        for (position, (name, value)) in fingerprint.entries().iter().enumerate() {
            transaction
                .execute(
                    "INSERT INTO fingerprint VALUES (?1, ?2, ?3)",
                    params![position as i64, name, value],
                )
                .map_err(fail)?;
        }
        transaction
            .pragma_update(None, "user_version", SCHEMA)
            .map_err(fail)?;
        transaction.commit().map_err(fail)
    }

    fn check_schema(&self) -> Result<()> {
        let found: i64 = self
            .connection
            .pragma_query_value(None, "user_version", |row| row.get(0))
            .map_err(|e| sql(&self.path, "read the results", &e))?;
        if found == SCHEMA {
            return Ok(());
        }
        Err(
            Error::conflict("the results have another layout than this version writes")
                .at_file(&self.path)
                .found(format!("layout {found}"))
                .allowed(format!("layout {SCHEMA}"))
                .advise(Advice::Restart)
                .advise(Advice::OtherFolder),
        )
    }

    /// The fingerprint that the store was created with.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn fingerprint(&self) -> Result<Fingerprint> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare("SELECT name, value FROM fingerprint ORDER BY position")
            .map_err(fail)?;
        let rows = statement
            .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))
            .map_err(fail)?;
        rows.collect::<rusqlite::Result<_>>().map_err(fail)
    }

    /// Keeps trials, all of them or none.
    ///
    /// # Errors
    /// A full disk or a trial that is already there.
    pub fn insert(&mut self, trials: &[Trial]) -> Result<()> {
        let path = self.path.clone();
        let fail = |e: rusqlite::Error| sql(&path, "write results", &e);
        let transaction = self.connection.transaction().map_err(fail)?;
        {
            let mut trial_row = transaction
                .prepare_cached("INSERT INTO trial VALUES (?1, ?2)")
                .map_err(fail)?;
            let mut outcome_row = transaction
                .prepare_cached("INSERT INTO outcome VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")
                .map_err(fail)?;
            for trial in trials {
                trial_row
                    .execute(params![trial.index as i64, to_bytes(&trial.values)])
                    .map_err(fail)?;
                for (position, outcome) in trial.outcomes.iter().enumerate() {
                    let diverged = match &outcome.status {
                        OutcomeStatus::Completed => None,
                        OutcomeStatus::Diverged(why) => Some(why.as_str()),
                    };
                    let displacement = Some(outcome.net_displacement_m).filter(|d| d.is_finite());
                    outcome_row
                        .execute(params![
                            trial.index as i64,
                            position as i64,
                            diverged,
                            outcome.steps as i64,
                            displacement,
                            to_bytes(&outcome.scores),
                            to_bytes(outcome.path_xy_m.as_flattened()),
                        ])
                        .map_err(fail)?;
                }
            }
        }
        transaction.commit().map_err(fail)
    }

    /// Keeps named texts that say what the trials are, so that the store explains itself; old values are replaced.
    ///
    /// # Errors
    /// A full disk or a store that cannot be written.
    pub fn describe<'a>(
        &mut self,
        entries: impl IntoIterator<Item = (&'a str, String)>,
    ) -> Result<()> {
        let path = self.path.clone();
        let fail = |e: rusqlite::Error| sql(&path, "write the results", &e);
        let transaction = self.connection.transaction().map_err(fail)?;
        for (name, value) in entries {
            transaction
                .execute(
                    "INSERT OR REPLACE INTO description VALUES (?1, ?2)",
                    params![name, value],
                )
                .map_err(fail)?;
        }
        transaction.commit().map_err(fail)
    }

    /// What [`Store::describe`] kept.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn description(&self) -> Result<BTreeMap<String, String>> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare("SELECT name, value FROM description")
            .map_err(fail)?;
        let rows = statement
            .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))
            .map_err(fail)?;
        rows.collect::<rusqlite::Result<_>>().map_err(fail)
    }

    /// Keeps the scores of trials; scores of the same trial are replaced (a basis fitted later changes them).
    ///
    /// # Errors
    /// A full disk or a store that cannot be written.
    pub fn insert_scores(&mut self, scores: &[TrialScore]) -> Result<()> {
        let path = self.path.clone();
        let fail = |e: rusqlite::Error| sql(&path, "write the results", &e);
        let transaction = self.connection.transaction().map_err(fail)?;
        {
            let mut row = transaction
                .prepare("INSERT OR REPLACE INTO score VALUES (?1, ?2, ?3, ?4)")
                .map_err(fail)?;
            for score in scores {
                row.execute(params![
                    score.index as i64,
                    score.score,
                    score.displacement_error_m,
                    to_bytes(&score.recordings)
                ])
                .map_err(fail)?;
            }
        }
        transaction.commit().map_err(fail)
    }

    /// The scores that are there, by trial.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn scores(&self) -> Result<Vec<TrialScore>> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare(
                "SELECT trial, score, displacement_error_m, recordings FROM score ORDER BY trial",
            )
            .map_err(fail)?;
        let rows = statement
            .query_map([], |row| {
                Ok(TrialScore {
                    index: row.get::<_, i64>(0)? as usize,
                    score: row.get(1)?,
                    displacement_error_m: row.get(2)?,
                    recordings: from_bytes(row.get_ref(3)?.as_blob()?),
                })
            })
            .map_err(fail)?;
        rows.collect::<rusqlite::Result<_>>().map_err(fail)
    }

    /// Indices of the trials that are there.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn finished(&self) -> Result<BTreeSet<usize>> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare("SELECT id FROM trial")
            .map_err(fail)?;
        let rows = statement
            .query_map([], |row| row.get::<_, i64>(0))
            .map_err(fail)?;
        rows.map(|row| row.map(|id| id as usize))
            .collect::<rusqlite::Result<_>>()
            .map_err(fail)
    }

    /// All trials, by index.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn trials(&self) -> Result<Vec<Trial>> {
        self.trials_within(0..i64::MAX as usize)
    }

    /// The trials with an index in `range`, by index.
    ///
    /// # Errors
    /// A store that cannot be read.
    pub fn trials_within(&self, range: std::ops::Range<usize>) -> Result<Vec<Trial>> {
        let fail = |e: rusqlite::Error| sql(&self.path, "read the results", &e);
        let mut statement = self
            .connection
            .prepare("SELECT id, parameters FROM trial WHERE id >= ?1 AND id < ?2 ORDER BY id")
            .map_err(fail)?;
        let rows = statement
            .query_map([range.start as i64, range.end as i64], |row| {
                Ok(Trial {
                    index: row.get::<_, i64>(0)? as usize,
                    values: from_bytes(row.get_ref(1)?.as_blob()?),
                    outcomes: Vec::new(),
                })
            })
            .map_err(fail)?;
        let mut trials: Vec<Trial> = rows.collect::<rusqlite::Result<_>>().map_err(fail)?;
        let mut statement = self
            .connection
            .prepare("SELECT diverged, steps, net_displacement_m, scores, path_xy_m FROM outcome WHERE trial = ?1 ORDER BY position")
            .map_err(fail)?;
        for trial in &mut trials {
            let rows = statement
                .query_map([trial.index as i64], |row| {
                    let diverged: Option<String> = row.get(0)?;
                    let flat: Vec<f64> = from_bytes(row.get_ref(4)?.as_blob()?);
                    Ok(Outcome {
                        status: diverged.map_or(OutcomeStatus::Completed, OutcomeStatus::Diverged),
                        steps: row.get::<_, i64>(1)? as u64,
                        net_displacement_m: row.get::<_, Option<f64>>(2)?.unwrap_or(f64::NAN),
                        scores: from_bytes(row.get_ref(3)?.as_blob()?),
                        path_xy_m: flat.chunks_exact(2).map(|p| [p[0], p[1]]).collect(),
                    })
                })
                .map_err(fail)?;
            trial.outcomes = rows.collect::<rusqlite::Result<_>>().map_err(fail)?;
        }
        Ok(trials)
    }
}

fn lock(folder: &Path) -> Result<FolderLock> {
    fs::create_dir_all(folder).map_err(|e| Error::io("make the results folder", folder, &e))?;
    FolderLock::acquire(folder)
}

/// Opens for writing. WAL with `synchronous = NORMAL`: a killed process loses at most the
/// transaction under way, a power cut at most the last few; neither corrupts the file.
fn connect(path: &Path) -> Result<Connection> {
    let fail = |e: rusqlite::Error| sql(path, "open the results", &e);
    let connection = Connection::open(path).map_err(fail)?;
    connection
        .query_row("PRAGMA journal_mode = WAL", [], |row| {
            row.get::<_, String>(0)
        })
        .optional()
        .map_err(fail)?;
    connection
        .pragma_update(None, "synchronous", "NORMAL")
        .map_err(fail)?;
    Ok(connection)
}

fn sql(path: &Path, doing: &str, error: &rusqlite::Error) -> Error {
    use rusqlite::ErrorCode;
    let message = format!("cannot {doing}: {error}");
    let plain = || Error::conflict(message.clone()).at_file(path);
    match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => plain()
            .hint("free some disk space; what was stored so far is safe")
            .advise(Advice::Resume),
        Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => plain()
            .hint("check the permissions of the folder")
            .advise(Advice::OtherFolder),
        Some(ErrorCode::SystemIoFailure) => plain()
            .hint("the disk may be full or failing; free some space")
            .advise(Advice::Resume),
        Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt) => plain()
            .hint("the file is not a results store")
            .advise(Advice::Restart)
            .advise(Advice::OtherFolder),
        _ => plain(),
    }
}

/// Little-endian bytes: every bit of every number is kept.
fn to_bytes(values: &[f64]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn from_bytes(bytes: &[u8]) -> Vec<f64> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|chunk| f64::from_le_bytes(*chunk))
        .collect()
}
