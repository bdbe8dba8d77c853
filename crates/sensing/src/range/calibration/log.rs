//! Reads logs of readings at known distances.

use std::path::Path;

use crate::range::model::ReadingUnit;
use realgap_core::error::{Error, Result};
use realgap_core::file::{LogTable, read_log_text};
use realgap_core::unit::{LengthUnit, counted};
use realgap_core::warning::{Code, Warning};

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// True distance, in the log's unit, above 0.
    pub distance: f64,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Angle of offset, degrees.
    pub offset_deg: f64,
    /// Index of the session in [`ReadingLog::sessions`]; 0 if the log names no sessions.
    pub session: usize,
    /// The reading of the sensor; `None` for a dropout.
    pub value: Option<f64>,
}

/// Readings of one sensor at known distances.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingLog {
    /// Unit of the distances.
    pub distance_unit: LengthUnit,
    /// Unit of the readings.
    pub reading_unit: ReadingUnit,
    /// The readings, in the order of the log.
    pub readings: Vec<Reading>,
    /// Names of the sessions in the order of the log; empty if the log names no sessions.
    pub sessions: Vec<String>,
    /// Material to which the log was limited.
    pub material: Option<String>,
    /// Time from one reading to the next, seconds; `None` if the log has no times.
    pub sampling_time_s: Option<f64>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// Options of reading a log.
#[derive(Debug, Clone, Default)]
pub struct LogOptions {
    /// Unit of a column `distance`, whose name does not state a unit.
    pub unit: LengthUnit,
    /// Use only readings from this material.
    pub material: Option<String>,
    /// The column that names sessions; by default the column `session`, if there is one.
    pub session: Option<String>,
}

/// The names that columns may have.
const COLUMNS: &str = "distance_cm (or _m, _mm, or `distance`), reading_cm (or _m, _mm, any other ending for the sensor's own unit, or \
     `reading`), and where known incidence_deg, offset_deg, material, session, t_s";

impl ReadingLog {
    /// Reads a log with all defaults.
    ///
    /// # Errors
    /// As [`ReadingLog::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &LogOptions::default())
    }

    /// Reads a log.
    ///
    /// # Errors
    /// A missing file, missing columns, distances that are not positive numbers, cells that are not numbers, no rows.
    pub fn read_with(path: impl AsRef<Path>, options: &LogOptions) -> Result<Self> {
        let path = path.as_ref();
        Self::parse_with(path, &read_log_text(path)?, options)
    }

    /// Parses a log from a text; errors name it by `path`.
    ///
    /// # Errors
    /// As [`ReadingLog::read_with`].
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        Self::parse_with(path.as_ref(), text, &LogOptions::default())
    }

    /// As [`ReadingLog::parse`], with options.
    ///
    /// # Errors
    /// As [`ReadingLog::read_with`].
    pub fn parse_with(path: &Path, text: &str, options: &LogOptions) -> Result<Self> {
        let table = LogTable::parse(path, text)?;
        let (distance, distance_unit) = distance_column(&table, options.unit)?;
        let (reading, reading_unit) = reading_column(&table)?;
        let angle = |name: &str| -> Option<(usize, f64)> {
            [
                (format!("{name}_deg"), 1.0),
                (format!("{name}_rad"), 1f64.to_degrees()),
                (name.to_owned(), 1.0),
            ]
            .into_iter()
            .find_map(|(column, degrees)| Some((table.column(&column)?, degrees)))
        };
        let (incidence, offset) = (angle("incidence"), angle("offset"));
        let wanted = options.material.as_deref();
        let (rows, materials) = table.chosen("material", wanted)?;
        let time = table.column("t_s");
        let session = match &options.session {
            Some(name) => {
                Some(table.require(name, "the options name this column as the one of sessions")?)
            }
            None => table.column("session"),
        };
        let mut log = Self {
            distance_unit,
            reading_unit,
            readings: Vec::with_capacity(rows.len()),
            sessions: Vec::new(),
            material: options.material.clone(),
            sampling_time_s: None,
            warnings: Vec::new(),
        };
        let (mut times_s, mut impossible) = (Vec::new(), 0);
        for row in rows {
            let distance_found = table.number(row, distance)?;
            if distance_found <= 0.0 {
                let error = Error::invalid("a distance must be above 0")
                    .field(&table.header()[distance])
                    .found(distance_found);
                return Err(table.at(row, error));
            }
            let mut value = table.optional(row, reading)?;
            // Many sensors report a length that is not positive if they receive no echo.
            if matches!(log.reading_unit, ReadingUnit::Length(_)) && value.is_some_and(|v| v <= 0.0)
            {
                value = None;
                impossible += 1;
            }
            let degrees = |column: Option<(usize, f64)>| -> Result<f64> {
                match column {
                    Some((column, factor)) => Ok(factor * table.number(row, column)?),
                    None => Ok(0.0),
                }
            };
            if let Some(column) = time {
                times_s.push(table.number(row, column)?);
            }
            let session = session.map_or(0, |column| log.session(table.text(row, column)));
            log.readings.push(Reading {
                distance: distance_found,
                incidence_deg: degrees(incidence)?,
                offset_deg: degrees(offset)?,
                session,
                value,
            });
        }
        if log.sessions.len() == 1 {
            log.sessions.clear();
        }
        let steps_s: Vec<f64> = times_s
            .windows(2)
            .map(|w| w[1] - w[0])
            .filter(|dt| *dt > 0.0)
            .collect();
        if !steps_s.is_empty() {
            log.sampling_time_s = Some(realgap_core::statistics::median(&steps_s));
        }
        if wanted.is_none() && materials.len() > 1 {
            log.warnings.push(Code::SeveralMaterials.warning(format!(
                "readings from {} are fitted as one sensor; choose one material to fit it separately",
                materials.join(", ")
            )));
        }
        if impossible > 0 {
            log.warnings.push(Code::ImpossibleReadings.warning(format!(
                "{} of 0 or below counted as dropouts",
                counted(impossible, "reading")
            )));
        }
        Ok(log)
    }

    /// The index of the session with this name; a new name is added to the sessions.
    fn session(&mut self, name: &str) -> usize {
        let known = self.sessions.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.sessions.push(name.to_owned());
            self.sessions.len() - 1
        })
    }
}

fn length_column(table: &LogTable, name: &str) -> Option<(usize, LengthUnit)> {
    [
        ("m", LengthUnit::Metre),
        ("cm", LengthUnit::Centimetre),
        ("mm", LengthUnit::Millimetre),
    ]
    .into_iter()
    .find_map(|(symbol, unit)| Some((table.column(&format!("{name}_{symbol}"))?, unit)))
}

fn distance_column(table: &LogTable, unit: LengthUnit) -> Result<(usize, LengthUnit)> {
    if let Some(found) = length_column(table, "distance") {
        return Ok(found);
    }
    let hint = format!("a log of readings has the columns {COLUMNS}");
    Ok((table.require("distance", &hint)?, unit))
}

fn reading_column(table: &LogTable) -> Result<(usize, ReadingUnit)> {
    if let Some((column, unit)) = length_column(table, "reading") {
        return Ok((column, ReadingUnit::Length(unit)));
    }
    let own = table
        .header()
        .iter()
        .enumerate()
        .find_map(|(column, name)| {
            Some((
                column,
                ReadingUnit::Own(name.strip_prefix("reading_")?.to_owned()),
            ))
        });
    if let Some(found) = own {
        return Ok(found);
    }
    let hint = format!("a log of readings has the columns {COLUMNS}");
    Ok((
        table.require("reading", &hint)?,
        ReadingUnit::Own(String::new()),
    ))
}
