//! Reads logs of radio strengths at known positions, and lists of anchors.

use std::path::Path;

use crate::arena::Anchor;
use realgap_core::error::{Error, Result};
use realgap_core::file::{LogTable, read_log_text};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// One strength at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceReading {
    /// Row of the log, from 0.
    pub row: usize,
    /// Position of the robot, metres.
    pub position_m: [f64; 2],
    /// Index of the received anchor in [`RadioLog::anchors`].
    pub anchor: usize,
    /// Strength of the signal, dBm.
    pub strength_dbm: f64,
}

/// Strengths along a robot's path.
#[derive(Debug, Clone, PartialEq)]
pub struct RadioLog {
    /// Names of the anchors, as in the columns.
    pub anchors: Vec<String>,
    /// All strengths that were received.
    pub readings: Vec<PlaceReading>,
    /// Number of poses of the log.
    pub poses: usize,
    /// Number of missing strengths.
    pub missing: usize,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// Options of reading a log.
#[derive(Debug, Clone, Default)]
pub struct RadioLogOptions {
    /// Use only rows with this value in the column `session`.
    pub session: Option<String>,
}

/// Possible strengths, dBm. Loggers report strengths outside of this interval if no signal was received.
const POSSIBLE_DBM: std::ops::Range<f64> = -120.0..0.0;
/// The names that columns may have.
const COLUMNS: &str = "a log of strengths has the columns x_m, y_m, one that ends in _dbm for every anchor (anchor_1_dbm …), and where \
     there are several sessions `session`";

impl RadioLog {
    /// Reads a log with all defaults.
    ///
    /// # Errors
    /// As [`RadioLog::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &RadioLogOptions::default())
    }

    /// Reads a log.
    ///
    /// # Errors
    /// A missing file, missing columns, cells that are not numbers, no strength at all, no row of the session.
    pub fn read_with(path: impl AsRef<Path>, options: &RadioLogOptions) -> Result<Self> {
        let path = path.as_ref();
        Self::parse_with(path, &read_log_text(path)?, options)
    }

    /// Parses a log from a text; errors name it by `path`.
    ///
    /// # Errors
    /// As [`RadioLog::read_with`].
    pub fn parse_with(
        path: impl AsRef<Path>,
        text: &str,
        options: &RadioLogOptions,
    ) -> Result<Self> {
        let path = path.as_ref();
        let table = LogTable::parse(path, text)?;
        let (x, y) = (
            table.require("x_m", COLUMNS)?,
            table.require("y_m", COLUMNS)?,
        );
        let columns: Vec<(usize, String)> = table
            .header()
            .iter()
            .enumerate()
            .filter_map(|(column, name)| {
                let name = name.strip_suffix("_dbm")?;
                let name = name.strip_prefix("anchor_").unwrap_or(name);
                Some((column, name.to_owned()))
            })
            .collect();
        if columns.is_empty() {
            return Err(Error::invalid("the log has no strengths")
                .at_file(path)
                .at_line(1, 1)
                .found(table.header().join(", "))
                .hint(COLUMNS));
        }
        let wanted = options.session.as_deref();
        let (rows, sessions) = table.chosen("session", wanted)?;
        let mut log = Self {
            anchors: columns.iter().map(|(_, name)| name.clone()).collect(),
            readings: Vec::new(),
            poses: rows.len(),
            missing: 0,
            warnings: Vec::new(),
        };
        let mut impossible = 0;
        for row in rows {
            let position_m = [table.number(row, x)?, table.number(row, y)?];
            for (anchor, (column, _)) in columns.iter().enumerate() {
                match table.optional(row, *column)? {
                    Some(strength_dbm) if POSSIBLE_DBM.contains(&strength_dbm) => {
                        log.readings.push(PlaceReading {
                            row,
                            position_m,
                            anchor,
                            strength_dbm,
                        });
                    }
                    Some(_) => impossible += 1,
                    None => log.missing += 1,
                }
            }
        }
        log.missing += impossible;
        if log.readings.is_empty() {
            return Err(Error::invalid("no signal was received in the whole log")
                .at_file(path)
                .found(format!(
                    "{} empty, {impossible} of 0 dBm or more or under -120 dBm",
                    log.missing - impossible
                ))
                .allowed("strengths between -120 and 0 dBm")
                .hint(COLUMNS));
        }
        if impossible > 0 {
            log.warnings.push(Code::ImpossibleReadings.warning(format!(
                "{} of 0 dBm or more, or under -120 dBm, counted as not received",
                counted(impossible, "strength")
            )));
        }
        if wanted.is_none() && sessions.len() > 1 {
            log.warnings.push(Code::SeveralSessions.warning(format!(
                "sessions {} are used together; choose one session for the fit to evaluate the model on the others",
                sessions.join(", ")
            )));
        }
        Ok(log)
    }

    /// The anchors of an arena that correspond to the anchors of the log, in the order of the log.
    ///
    /// # Errors
    /// An anchor of the log whose position is unknown.
    pub fn placed(&self, anchors: &[Anchor]) -> Result<Vec<Anchor>> {
        let find = |name: &String| {
            anchors
                .iter()
                .find(|anchor| anchor.name == *name)
                .cloned()
                .ok_or_else(|| {
                    let known: Vec<&str> = anchors.iter().map(|a| a.name.as_str()).collect();
                    Error::invalid("the position of an anchor of the log is unknown")
                        .found(name)
                        .allowed(if known.is_empty() {
                            "this arena has no anchors".to_owned()
                        } else {
                            known.join(", ")
                        })
                        .hint("write `anchors: [(name: \"1\", position_m: (x, y, z)), …]` into the arena, or give a CSV of id,x,y,z")
                })
        };
        self.anchors.iter().map(find).collect()
    }
}

/// Reads the positions of anchors from a CSV with the columns id, x, y and z (metres).
///
/// # Errors
/// A missing file, missing columns, cells that are not numbers, a repeated name.
pub fn read_anchors(path: impl AsRef<Path>) -> Result<Vec<Anchor>> {
    let path = path.as_ref();
    let table = LogTable::parse(path, &read_log_text(path)?)?;
    let hint = "a list of anchors has the columns id, x, y, z (metres)";
    let column = |name: &str| match table.column(&format!("{name}_m")) {
        Some(column) => Ok(column),
        None => table.require(name, hint),
    };
    let id = table.require("id", hint)?;
    let axes = [column("x")?, column("y")?, column("z")?];
    let mut anchors = Vec::new();
    for row in 0..table.row_count() {
        let mut position_m = [0.0; 3];
        for (value, axis) in position_m.iter_mut().zip(axes) {
            *value = table.number(row, axis)?;
        }
        let anchor = Anchor {
            name: table.text(row, id).to_owned(),
            position_m,
        };
        anchor.check(&anchors).map_err(|e| table.at(row, e))?;
        anchors.push(anchor);
    }
    Ok(anchors)
}
