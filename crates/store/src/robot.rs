//! The stored row of one evaluated robot of a search.

use rusqlite::{Connection, Transaction, params};

use super::checksum::{Checksum, from_bytes, to_bytes};
use super::row::{Checked, Row, Table};

/// An evaluated robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotRow {
    /// Position in the search's order, from 0.
    pub index: usize,
    /// The genome, ten numbers per module.
    pub genome: Vec<f64>,
    /// The outcome of the evaluation.
    pub outcome: RobotOutcome,
}

/// The outcome of a robot's evaluation.
#[derive(Debug, Clone, PartialEq)]
pub enum RobotOutcome {
    /// Every repeat was simulated to its end.
    Walked {
        /// The value that the search maximises.
        fitness: f64,
        /// The motion of each repeat, in order.
        repeats: Vec<TravelRow>,
        /// The descriptors that the search's strategy uses, in its order.
        descriptors: Vec<f64>,
    },
    /// The robot failed and has no fitness.
    Failed {
        /// Short name of the reason.
        reason: String,
        /// The observation behind the reason, in words.
        seen: String,
    },
}

/// The motion of one repeat of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelRow {
    /// Distance in the plane from the start (or from the first counted position) to the end, metres.
    pub displacement_m: f64,
    /// Length of the path, metres.
    pub path_length_m: f64,
    /// Change of the heading, radians, positive to the left.
    pub turned_rad: f64,
    /// Energy that the servos delivered meanwhile, joules; `None` if it was not measured.
    pub servo_j: Option<f64>,
}

impl TravelRow {
    /// Displacement per path length; 0 below one body length of displacement, because the path then has no clear direction.
    pub fn straightness(&self, body_length_m: f64) -> f64 {
        if self.displacement_m < body_length_m {
            return 0.0;
        }
        (self.displacement_m / self.path_length_m).min(1.0)
    }

    /// Displacement per energy, m/J; 0 below one body length, and if the servos delivered no energy or it was not measured.
    pub fn metres_per_joule(&self, body_length_m: f64) -> f64 {
        match self.servo_j {
            Some(servo_j) if servo_j > 0.0 && self.displacement_m >= body_length_m => {
                self.displacement_m / servo_j
            }
            _ => 0.0,
        }
    }
}

/// The text in the column `status` of a robot that was simulated to its end.
const WALKED: &str = "walked";

/// A row in the form in which SQLite stores it.
struct Columns {
    genome: Vec<u8>,
    status: String,
    seen: String,
    fitness: Option<f64>,
    /// Blobs of displacements, path lengths, heading changes, energies (NaN if not measured) and descriptors.
    lists: [Vec<u8>; 5],
}

impl Columns {
    fn of(row: &RobotRow) -> Self {
        let genome = to_bytes(&row.genome);
        match &row.outcome {
            RobotOutcome::Failed { reason, seen } => Self {
                genome,
                status: reason.clone(),
                seen: seen.clone(),
                fitness: None,
                lists: Default::default(),
            },
            RobotOutcome::Walked {
                fitness,
                repeats,
                descriptors,
            } => {
                let list = |value: fn(&TravelRow) -> f64| {
                    to_bytes(&repeats.iter().map(value).collect::<Vec<_>>())
                };
                Self {
                    genome,
                    status: WALKED.to_owned(),
                    seen: String::new(),
                    // SQLite has no NaN, so NaN is stored as NULL.
                    fitness: Some(*fitness).filter(|fitness| !fitness.is_nan()),
                    lists: [
                        list(|travel| travel.displacement_m),
                        list(|travel| travel.path_length_m),
                        list(|travel| travel.turned_rad),
                        list(|travel| travel.servo_j.unwrap_or(f64::NAN)),
                        to_bytes(descriptors),
                    ],
                }
            }
        }
    }

    fn row(self, index: usize) -> RobotRow {
        let outcome = if self.status == WALKED {
            let [
                displacements_m,
                lengths_m,
                turned_rad,
                servos_j,
                descriptors,
            ] = self.lists.map(|bytes| from_bytes(&bytes));
            let paths = displacements_m.iter().zip(&lengths_m).zip(&turned_rad);
            let repeats = paths.zip(&servos_j);
            RobotOutcome::Walked {
                fitness: self.fitness.unwrap_or(f64::NAN),
                repeats: repeats
                    .map(
                        |(((displacement_m, path_length_m), turned_rad), servo_j)| TravelRow {
                            displacement_m: *displacement_m,
                            path_length_m: *path_length_m,
                            turned_rad: *turned_rad,
                            servo_j: Some(*servo_j).filter(|servo_j| !servo_j.is_nan()),
                        },
                    )
                    .collect(),
                descriptors,
            }
        } else {
            RobotOutcome::Failed {
                reason: self.status,
                seen: self.seen,
            }
        };
        RobotRow {
            index,
            genome: from_bytes(&self.genome),
            outcome,
        }
    }

    fn checksum(&self, index: usize) -> i64 {
        let checksum = Checksum::of(RobotRow::NAME)
            .whole(index as i64)
            .bytes(&self.genome)
            .text(&self.status)
            .text(&self.seen)
            .number(self.fitness);
        let all = self.lists.iter();
        all.fold(checksum, |checksum, list| checksum.bytes(list))
            .finish()
    }
}

impl RobotRow {
    /// The approximate number of bytes that the row takes in a store.
    pub fn stored_bytes(&self) -> usize {
        let columns = Columns::of(self);
        let lists: usize = columns.lists.iter().map(Vec::len).sum();
        40 + columns.genome.len() + columns.status.len() + columns.seen.len() + lists
    }
}

impl Row for RobotRow {
    fn index(&self) -> usize {
        self.index
    }
}

impl Table for RobotRow {
    const NAME: &'static str = "robot";
    const TABLES: &'static str = "CREATE TABLE robot (
        id INTEGER PRIMARY KEY, genome BLOB NOT NULL, status TEXT NOT NULL, seen TEXT NOT NULL, fitness REAL,
        displacement_m BLOB NOT NULL, path_length_m BLOB NOT NULL, turned_rad BLOB NOT NULL,
        servo_j BLOB NOT NULL, descriptors BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT;";

    fn insert(&self, transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
        let columns = Columns::of(self);
        let checksum = columns.checksum(self.index);
        let [displacements, lengths, turned, energies, descriptors] = &columns.lists;
        transaction
            .prepare_cached(
                "INSERT INTO robot VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)",
            )?
            .execute(params![
                self.index as i64,
                columns.genome,
                columns.status,
                columns.seen,
                columns.fitness,
                displacements,
                lengths,
                turned,
                energies,
                descriptors,
                checksum
            ])?;
        Ok(checksum)
    }

    fn read(connection: &Connection, from: i64, to: i64) -> rusqlite::Result<Vec<Checked<Self>>> {
        let mut statement = connection.prepare_cached(
            "SELECT id, genome, status, seen, fitness, displacement_m, path_length_m, turned_rad, servo_j, descriptors, checksum
             FROM robot WHERE id >= ?1 AND id < ?2 ORDER BY id",
        )?;
        let rows = statement.query_map([from, to], |row| {
            let index = row.get::<_, i64>(0)? as usize;
            let columns = Columns {
                genome: row.get(1)?,
                status: row.get(2)?,
                seen: row.get(3)?,
                fitness: row.get(4)?,
                lists: [
                    row.get(5)?,
                    row.get(6)?,
                    row.get(7)?,
                    row.get(8)?,
                    row.get(9)?,
                ],
            };
            Ok(Checked {
                stored: row.get(10)?,
                computed: columns.checksum(index),
                row: columns.row(index),
            })
        })?;
        rows.collect()
    }
}
