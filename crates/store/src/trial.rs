//! The stored row of one evaluated point of a study, and its scores.

use rusqlite::{Connection, OptionalExtension as _, Transaction, params};

use super::checksum::{Checksum, from_bytes, to_bytes};
use super::row::{Checked, Row, Table};

/// The simulation of one case: one start, compared with one or more recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseRow {
    /// Number of simulated steps.
    pub steps: u64,
    /// The outcome of the simulation.
    pub outcome: CaseOutcome,
}

/// The outcome of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum CaseOutcome {
    /// The whole duration was simulated.
    Completed(CaseResult),
    /// The simulation diverged; the text says when and why.
    Diverged(String),
}

/// The stored results of a case that was simulated to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResult {
    /// Length of the net displacement in the plane, metres.
    pub net_displacement_m: f64,
    /// Scores against the case's recordings, in order; empty if the metric needs a basis. If an optimizer uses single errors, those of all
    /// these recordings follow after the scores.
    pub scores: Vec<f64>,
    /// The prepared path, metres, if it is needed later; otherwise empty.
    pub path_xy_m: Vec<[f64; 2]>,
}

impl CaseRow {
    /// The results, if the case was simulated to its end.
    pub fn completed(&self) -> Option<&CaseResult> {
        match &self.outcome {
            CaseOutcome::Completed(result) => Some(result),
            CaseOutcome::Diverged(_) => None,
        }
    }

    /// The reason for divergence, if the case diverged.
    pub fn diverged(&self) -> Option<&str> {
        match &self.outcome {
            CaseOutcome::Completed(_) => None,
            CaseOutcome::Diverged(why) => Some(why),
        }
    }
}

/// One evaluated point: parameter values and one row per case.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Index of the point in the study's order.
    pub index: usize,
    /// Values of the study's parameters, in the study's order.
    pub values: Vec<f64>,
    /// One row per case.
    pub cases: Vec<CaseRow>,
}

impl Trial {
    /// The approximate number of bytes that the row takes in a store.
    pub fn stored_bytes(&self) -> usize {
        let numbers = |case: &CaseRow| {
            case.completed().map_or(0, |result| {
                1 + result.scores.len() + 2 * result.path_xy_m.len()
            })
        };
        let cases: usize = self.cases.iter().map(|c| 16 + 8 * numbers(c)).sum();
        24 + 8 * self.values.len() + cases
    }

    /// The reason of the first case that diverged; `None` if every case was simulated to its end.
    pub fn diverged(&self) -> Option<&str> {
        self.cases.iter().find_map(CaseRow::diverged)
    }
}

/// Scores of one trial, as soon as they can be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialScore {
    /// Index of the trial.
    pub index: usize,
    /// Mean score over the recordings that were fitted; `None` if a case diverged.
    pub score: Option<f64>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
    /// Score against each recording, in order; empty if a case diverged.
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

    /// Checksum of the stored scores that these scores will replace.
    pub(super) fn replaced(&self, transaction: &Transaction<'_>) -> rusqlite::Result<Option<i64>> {
        transaction
            .prepare_cached("SELECT checksum FROM score WHERE trial = ?1")?
            .query_row([self.index as i64], |row| row.get(0))
            .optional()
    }

    /// All scores, sorted by trial.
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
    /// Checksum of the whole trial with all cases, so that a missing case is noticed too.
    fn checksum(&self) -> i64 {
        let trial = Checksum::of(Self::NAME)
            .whole(self.index as i64)
            .bytes(&to_bytes(&self.values))
            .whole(self.cases.len() as i64);
        self.cases
            .iter()
            .fold(trial, |checksum, case| {
                let checksum = match case.diverged() {
                    None => checksum.number(None),
                    Some(why) => checksum.whole(1).text(why),
                };
                let columns = Columns::of(case);
                checksum
                    .whole(case.steps as i64)
                    .number(columns.net_displacement_m)
                    .bytes(&columns.scores)
                    .bytes(&columns.path_xy_m)
            })
            .finish()
    }
}

/// The values of a case in the columns of its results; empty if the case diverged.
#[derive(Default)]
struct Columns {
    net_displacement_m: Option<f64>,
    scores: Vec<u8>,
    path_xy_m: Vec<u8>,
}

impl Columns {
    fn of(case: &CaseRow) -> Self {
        case.completed().map_or_else(Self::default, |result| Self {
            net_displacement_m: finite(result.net_displacement_m),
            scores: to_bytes(&result.scores),
            path_xy_m: to_bytes(result.path_xy_m.as_flattened()),
        })
    }
}

/// SQLite has no NaN, so a number that is not finite is stored as NULL.
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
        for (position, case) in self.cases.iter().enumerate() {
            let columns = Columns::of(case);
            row.execute(params![
                self.index as i64,
                position as i64,
                case.diverged(),
                case.steps as i64,
                columns.net_displacement_m,
                columns.scores,
                columns.path_xy_m,
            ])?;
        }
        Ok(checksum)
    }

    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>> {
        let mut trials = connection.prepare_cached(
            "SELECT id, parameters, checksum FROM trial WHERE id >= ?1 AND id < ?2 ORDER BY id",
        )?;
        let mut cases = connection.prepare_cached(
            "SELECT diverged, steps, net_displacement_m, scores, path_xy_m FROM outcome WHERE trial = ?1 ORDER BY position",
        )?;
        let rows = trials.query_map([from, to], |row| {
            let id: i64 = row.get(0)?;
            let cases = cases.query_map([id], |row| {
                let diverged: Option<String> = row.get(0)?;
                let flat = from_bytes(row.get_ref(4)?.as_blob()?);
                let outcome = match diverged {
                    Some(why) => CaseOutcome::Diverged(why),
                    None => CaseOutcome::Completed(CaseResult {
                        net_displacement_m: row.get::<_, Option<f64>>(2)?.unwrap_or(f64::NAN),
                        scores: from_bytes(row.get_ref(3)?.as_blob()?),
                        path_xy_m: flat.chunks_exact(2).map(|p| [p[0], p[1]]).collect(),
                    }),
                };
                let steps = row.get::<_, i64>(1)? as u64;
                Ok(CaseRow { steps, outcome })
            })?;
            let trial = Self {
                index: id as usize,
                values: from_bytes(row.get_ref(1)?.as_blob()?),
                cases: cases.collect::<rusqlite::Result<_>>()?,
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
