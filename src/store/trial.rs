//! What is kept of one evaluated point of a study.

use rusqlite::{Connection, OptionalExtension as _, Transaction, params};

use super::checksum::{Checksum, from_bytes, to_bytes};
use super::row::{Checked, Row, Table};

/// How the simulation of one case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum OutcomeStatus {
    /// The whole duration was simulated.
    Completed,
    /// The state became absurd; the reason.
    Diverged(String),
}

/// Result of simulating one case: one start, compared with one or more recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub status: OutcomeStatus,
    /// Steps taken.
    pub steps: u64,
    /// Length of the net displacement in the plane, metres; NaN when diverged.
    pub net_displacement_m: f64,
    /// Scores against the case's recordings, in order; empty where the metric needs a basis or the case diverged.
    pub scores: Vec<f64>,
    /// The prepared path, metres, where it is needed later; empty otherwise.
    pub path_xy_m: Vec<[f64; 2]>,
}

/// One evaluated point: parameter values and one outcome per case.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Index of the point in the study's order.
    pub index: usize,
    /// Values of the study's parameters, in the study's order.
    pub values: Vec<f64>,
    /// One outcome per case.
    pub outcomes: Vec<Outcome>,
}

impl Trial {
    /// Why a case diverged, the first that did; `None` where every case was simulated to its end.
    pub fn diverged(&self) -> Option<&str> {
        self.outcomes
            .iter()
            .find_map(|outcome| match &outcome.status {
                OutcomeStatus::Completed => None,
                OutcomeStatus::Diverged(why) => Some(why.as_str()),
            })
    }

    /// True where every case was simulated to its end.
    pub fn completed(&self) -> bool {
        self.outcomes
            .iter()
            .all(|outcome| outcome.status == OutcomeStatus::Completed)
    }
}

/// Scores of one trial, once they can be told.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialScore {
    /// Index of the trial.
    pub index: usize,
    /// Mean score over the recordings that were fitted; `None` where a case diverged.
    pub score: Option<f64>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
    /// Score against each recording, in order; empty where a case diverged.
    pub recordings: Vec<f64>,
}

impl TrialScore {
    /// Inserts the scores in place of older ones and returns their checksum.
    pub(super) fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
        let checksum = self.checksum();
        transaction
            .prepare_cached("INSERT OR REPLACE INTO score VALUES (?1, ?2, ?3, ?4, ?5)")?
            .execute(params![
                self.index as i64,
                self.score,
                self.displacement_error_m,
                to_bytes(&self.recordings),
                checksum
            ])?;
        Ok(checksum)
    }

    /// Checksum of the scores that these will replace.
    pub(super) fn replaced(&self, transaction: &Transaction<'_>) -> rusqlite::Result<Option<i64>> {
        transaction
            .prepare_cached("SELECT checksum FROM score WHERE trial = ?1")?
            .query_row([self.index as i64], |row| row.get(0))
            .optional()
    }

    /// All scores, by trial.
    pub(super) fn read(connection: &Connection) -> rusqlite::Result<Vec<Checked<Self>>> {
        let mut statement = connection.prepare_cached(
            "SELECT trial, score, displacement_error_m, recordings, checksum FROM score ORDER BY trial",
        )?;
        let rows = statement.query_map([], |row| {
            let score = Self {
                index: row.get::<_, i64>(0)? as usize,
                score: row.get(1)?,
                displacement_error_m: row.get(2)?,
                recordings: from_bytes(row.get_ref(3)?.as_blob()?),
            };
            Ok(Checked {
                stored: row.get(4)?,
                computed: score.checksum(),
                row: score,
            })
        })?;
        rows.collect()
    }

    fn checksum(&self) -> i64 {
        Checksum::of("score")
            .whole(self.index as i64)
            .number(self.score.filter(|score| !score.is_nan()))
            .number(self.displacement_error_m.filter(|error| !error.is_nan()))
            .bytes(&to_bytes(&self.recordings))
            .finish()
    }
}

impl Row for Trial {
    fn index(&self) -> usize {
        self.index
    }
}

impl Trial {
    /// The whole trial's: an outcome that is gone is noticed, too.
    fn checksum(&self) -> i64 {
        let trial = Checksum::of(Self::NAME)
            .whole(self.index as i64)
            .bytes(&to_bytes(&self.values))
            .whole(self.outcomes.len() as i64);
        self.outcomes
            .iter()
            .fold(trial, |checksum, outcome| {
                let checksum = match &outcome.status {
                    OutcomeStatus::Completed => checksum.number(None),
                    OutcomeStatus::Diverged(why) => checksum.whole(1).text(why),
                };
                checksum
                    .whole(outcome.steps as i64)
                    .number(finite(outcome.net_displacement_m))
                    .bytes(&to_bytes(&outcome.scores))
                    .bytes(&to_bytes(outcome.path_xy_m.as_flattened()))
            })
            .finish()
    }
}

/// SQLite has no NaN: it is kept as nothing.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

impl Table for Trial {
    const NAME: &'static str = "trial";
    const TABLES: &'static str = "CREATE TABLE trial (
            id INTEGER PRIMARY KEY, parameters BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT;
        CREATE TABLE outcome (
            trial INTEGER NOT NULL REFERENCES trial, position INTEGER NOT NULL,
            diverged TEXT, steps INTEGER NOT NULL, net_displacement_m REAL,
            scores BLOB NOT NULL, path_xy_m BLOB NOT NULL,
            PRIMARY KEY (trial, position)) STRICT, WITHOUT ROWID;
        CREATE TABLE score (
            trial INTEGER PRIMARY KEY REFERENCES trial, score REAL, displacement_error_m REAL,
            recordings BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT;";

    fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
        let checksum = self.checksum();
        transaction
            .prepare_cached("INSERT INTO trial VALUES (?1, ?2, ?3)")?
            .execute(params![self.index as i64, to_bytes(&self.values), checksum])?;
        let mut row = transaction
            .prepare_cached("INSERT INTO outcome VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")?;
        for (position, outcome) in self.outcomes.iter().enumerate() {
            let diverged = match &outcome.status {
                OutcomeStatus::Completed => None,
                OutcomeStatus::Diverged(why) => Some(why.as_str()),
            };
            row.execute(params![
                self.index as i64,
                position as i64,
                diverged,
                outcome.steps as i64,
                finite(outcome.net_displacement_m),
                to_bytes(&outcome.scores),
                to_bytes(outcome.path_xy_m.as_flattened()),
            ])?;
        }
        Ok(checksum)
    }

    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>> {
        let mut trials = connection.prepare_cached(
            "SELECT id, parameters, checksum FROM trial WHERE id >= ?1 AND id < ?2 ORDER BY id",
        )?;
        let mut outcomes = connection.prepare_cached(
            "SELECT diverged, steps, net_displacement_m, scores, path_xy_m FROM outcome WHERE trial = ?1 ORDER BY position",
        )?;
        let rows = trials.query_map([from, to], |row| {
            let id: i64 = row.get(0)?;
            let outcomes = outcomes.query_map([id], |row| {
                let diverged: Option<String> = row.get(0)?;
                let flat = from_bytes(row.get_ref(4)?.as_blob()?);
                Ok(Outcome {
                    status: diverged.map_or(OutcomeStatus::Completed, OutcomeStatus::Diverged),
                    steps: row.get::<_, i64>(1)? as u64,
                    net_displacement_m: row.get::<_, Option<f64>>(2)?.unwrap_or(f64::NAN),
                    scores: from_bytes(row.get_ref(3)?.as_blob()?),
                    path_xy_m: flat.chunks_exact(2).map(|p| [p[0], p[1]]).collect(),
                })
            })?;
            let trial = Self {
                index: id as usize,
                values: from_bytes(row.get_ref(1)?.as_blob()?),
                outcomes: outcomes.collect::<rusqlite::Result<_>>()?,
            };
            Ok(Checked {
                stored: row.get(2)?,
                computed: trial.checksum(),
                row: trial,
            })
        })?;
        rows.collect()
    }

    fn more_checksums(connection: &Connection) -> rusqlite::Result<Vec<(i64, i64)>> {
        let scores = TrialScore::read(connection)?;
        let checksums = scores.iter().map(|score| (score.stored, score.computed));
        Ok(checksums.collect())
    }
}
