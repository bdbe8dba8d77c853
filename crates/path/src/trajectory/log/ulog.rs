//! The file format ULog, which the autopilot PX4 records.

mod table;
mod walk;

use crate::trajectory::csv::Csv;
use crate::trajectory::format::{Decoded, Format, Parsed, Rendered};
use crate::trajectory::relabel::relabelled;
use crate::trajectory::{Reading, Trajectory};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

use super::mcap::{applied, renamed};

/// The logs of PX4 (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>).
///
/// Read are the positions of `vehicle_local_position` with the orientations of `vehicle_attitude`, the poses of `vehicle_odometry` and
/// its relatives, and, beside them, what the actuators were told. North, east, down become x north, y west, z up. If a log holds
/// several paths, the reading's `topic` selects one. Logs can be read but not written.
#[derive(Debug, Clone, Copy)]
pub struct Ulog;

/// The settings that concern the table: its axes are known.
fn of_table(reading: &Reading) -> Reading {
    Reading {
        axes: None,
        ..applied(reading)
    }
}

impl Format for Ulog {
    constant_methods! {
        name: &'static str = "ulog";
        doc: &'static str = "ULog: positions, attitude, odometry and actuators of a vehicle with PX4";
        extensions: &'static [&'static str] = &["ulg", "ulog"];
    }

    fn recognises(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(walk::MAGIC)
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let decoded = table::table(&bytes, reading)?;
        Ok(Decoded {
            text: relabelled(decoded.text, &renamed(reading))?,
            warnings: decoded.warnings,
        })
    }

    fn applied(&self, _text: &str, reading: &Reading) -> Reading {
        of_table(reading)
    }

    fn is_table(&self) -> bool {
        true
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, &of_table(reading))
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, &of_table(reading))
    }

    fn writes(&self) -> bool {
        false
    }

    fn render(&self, _trajectory: &Trajectory) -> Result<Rendered> {
        Err(Error::usage("logs of PX4 can be read but not written")
            .allowed("an .mcap or a .csv file"))
    }
}
