//! The file format of ROS 2 bags in SQLite (`.db3`).

use std::path::Path;

use super::mcap::{LARGE, applied, renamed};
use super::stream::{self, Log, Said};
use crate::trajectory::csv::Csv;
use crate::trajectory::format::{Decoded, Format, Parsed, Rendered};
use crate::trajectory::relabel::relabelled;
use crate::trajectory::{Reading, Trajectory};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};
use realgap_core::warning::Code;
use realgap_store::{read_bag, read_closed_bag, read_thin_bag};

/// The files that `ros2 bag record` writes with its storage `sqlite3`.
///
/// Messages encoded in CDR are read as by [`Mcap`](super::Mcap). Bags can be read but not written. A bag that its recorder has not closed is
/// read as if it were closed, together with the files `-wal` or `-journal` beside it. Of a large bag, only the messages that may be read are
/// taken into memory.
#[derive(Debug, Clone, Copy)]
pub struct Rosbag;

impl Format for Rosbag {
    constant_methods! {
        name: &'static str = "rosbag";
        doc: &'static str = "a bag of ROS 2 in SQLite: poses, odometry, transforms, a path or joints among its messages";
        extensions: &'static [&'static str] = &["db3"];
    }

    fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let is_large =
            std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() > LARGE);
        match is_large {
            true => read_thin_bag(path, limit, &stream::is_read),
            false => read_closed_bag(path, limit),
        }
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let mut log = Log::new(reading);
        let is_unfinished = read_bag(bytes, &mut |message| {
            let said = Said {
                topic: message.topic,
                kind: message.kind,
            };
            log.message(said, message.encoding, message.log_time_ns, message.data)
        })?;
        let mut decoded = log.table()?;
        if is_unfinished {
            decoded.warnings.push(Code::ReadAs.warning(
                "the recorder of this bag was stopped in the middle of a change: what it had not finished writing is left out",
            ));
        }
        Ok(Decoded {
            text: relabelled(decoded.text, &renamed(reading))?,
            warnings: decoded.warnings,
        })
    }

    fn applied(&self, _text: &str, reading: &Reading) -> Reading {
        applied(reading)
    }

    fn is_table(&self) -> bool {
        true
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, &applied(reading))
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, &applied(reading))
    }

    fn writes(&self) -> bool {
        false
    }

    fn render(&self, _trajectory: &Trajectory) -> Result<Rendered> {
        Err(Error::usage("bags of ROS 2 can be read but not written")
            .allowed("an .mcap file, which ROS 2 and Foxglove read"))
    }
}
