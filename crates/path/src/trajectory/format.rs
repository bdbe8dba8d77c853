//! The trait of file formats of trajectories, and the results of reading and writing.

use std::path::Path;

use super::column::Columns;
use super::text::decode_text;
use super::{QuaternionOrder, Reading, Trajectory};
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;
use realgap_core::warning::{Code, Warning};

/// A trajectory that was read from a text, with warnings.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// Warnings that the reader should know.
    pub warnings: Vec<Warning>,
}

/// The text that a format reads, with warnings about how it was taken from the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Decoded {
    /// The text of the file, or a table that is extracted from a binary file.
    pub text: String,
    /// Warnings that the reader should know.
    pub warnings: Vec<Warning>,
}

impl From<String> for Decoded {
    fn from(text: String) -> Self {
        Self {
            text,
            warnings: Vec::new(),
        }
    }
}

/// A trajectory that was written into the bytes of a file, with warnings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rendered {
    /// The bytes of the whole file.
    pub bytes: Vec<u8>,
    /// Warnings about data that the format cannot hold.
    pub warnings: Vec<Warning>,
}

/// A file format of trajectories.
///
/// Contract: [`Format::parse`] reads the output of [`Format::render`] back with the same bits, except for the data that
/// the warnings of `render` name; and `parse` never panics, for any text.
pub trait Format: Sync {
    /// Name, e.g. `csv`.
    fn name(&self) -> &'static str;
    /// Description of one line for people.
    fn doc(&self) -> &'static str;
    /// File extensions in lower case, without the dot; the first one is preferred.
    fn extensions(&self) -> &'static [&'static str];
    /// True if the bytes show that a file is of this format; this decides between formats with the same extension.
    fn recognises(&self, bytes: &[u8]) -> bool {
        let _ = bytes;
        false
    }
    /// True if a reading may state the names of the columns, because files of this format may have none.
    fn takes_header(&self) -> bool {
        false
    }
    /// The bytes of the file at `path`, at most `limit` + 1 bytes; if other files beside it belong to it, with their content
    /// included.
    ///
    /// # Errors
    /// A missing or unreadable file, or a folder.
    fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        read_limited(path, limit, "trajectory")
    }
    /// The text that the other methods read: the text of the file, or a table that is extracted from a binary file.
    ///
    /// # Errors
    /// Bytes that are not UTF-8, or not a file of this format.
    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let _ = reading;
        decode_text(bytes).map(Decoded::from)
    }
    /// Reads `text` with the settings of `reading`; settings that are not given have the defaults of this format.
    ///
    /// # Errors
    /// Anything that is not a trajectory in this format, with line and column.
    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed>;
    /// Reads the runs or bodies of `text` as separate trajectories: times start again, or rows alternate between several places.
    ///
    /// # Errors
    /// The errors of [`Format::parse`]; rows that cannot be told apart.
    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Ok(vec![self.parse(text, reading)?])
    }
    /// The settings of `reading` that concern this text; for example, a mapping is dropped if the text has none of its columns.
    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        let _ = text;
        // Units that are stated beside columns are those of a file with these columns.
        let is_of_columns = !reading.columns.is_empty();
        Reading {
            columns: Columns::default(),
            length: reading.length.filter(|_| !is_of_columns),
            scale: reading.scale.filter(|_| !is_of_columns),
            time: reading.time.filter(|_| !is_of_columns),
            angle: reading.angle.filter(|_| !is_of_columns),
            only: None,
            skip_lines: None,
            rate_hz: None,
            topic: None,
            command_topic: None,
            child_frame: None,
            ..reading.clone()
        }
    }
    /// The order in which the columns of the quaternion are read.
    fn order(&self, text: &str, reading: &Reading) -> QuaternionOrder {
        let _ = text;
        reading.quaternion.unwrap_or(QuaternionOrder::Wxyz)
    }
    /// True if files of this format have columns whose names may be those of other programs.
    fn is_table(&self) -> bool {
        false
    }
    /// The names of the columns; empty for formats without column names.
    fn columns<'a>(&self, text: &'a str, reading: &Reading) -> Vec<&'a str> {
        let _ = (text, reading);
        Vec::new()
    }
    /// Reads all recordings of a text that holds several: the rows with the same values of `group_columns` form a recording. The recordings
    /// are in order of first appearance, each with these values.
    ///
    /// # Errors
    /// The errors of [`Format::parse`]; a missing column; a format that cannot hold several recordings.
    fn parse_groups(
        &self,
        text: &str,
        reading: &Reading,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        let _ = (text, reading, group_columns);
        Err(Error::invalid("files of this format hold one recording each").found(self.name()))
    }
    /// True if files of this format can be written, too.
    fn writes(&self) -> bool {
        true
    }
    /// Writes a trajectory, in metres.
    ///
    /// # Errors
    /// A format whose files can only be read ([`Format::writes`]).
    fn render(&self, trajectory: &Trajectory) -> Result<Rendered>;
}

impl std::fmt::Debug for dyn Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Format({})", self.name())
    }
}

/// Warnings about data of this trajectory that a format with poses only cannot hold.
pub(super) fn beyond_poses(files: &str, trajectory: &Trajectory) -> Vec<Warning> {
    let found = [
        (
            !trajectory.joints().is_empty(),
            "angles of joints; they are left out",
        ),
        (
            trajectory.velocities_world_m_s().is_some(),
            "velocities; they are left out",
        ),
        (
            trajectory.is_planar(),
            "the fact that z is unknown; z is written as 0",
        ),
        (
            trajectory.orientations_world_from_body().is_none(),
            "the fact that orientation is unknown; it is written as the identity rotation",
        ),
    ];
    let lost = found.into_iter().filter(|(is_lost, _)| *is_lost);
    lost.map(|(_, what)| not_written(files, what)).collect()
}

/// The warning that files of a format cannot store something.
pub(super) fn not_written(files: &str, what: &str) -> Warning {
    Code::NotWritten.warning(format!("{files} cannot store {what}"))
}
