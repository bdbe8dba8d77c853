//! What a file format of trajectories is.

use std::path::Path;

use super::column::Columns;
use super::text::decode_text;
use super::{QuaternionOrder, Reading, Trajectory};
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;
use realgap_core::warning::{Code, Warning};

/// What a format found in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed {
    /// The motion.
    pub trajectory: Trajectory,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// A trajectory as a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rendered {
    /// The whole file.
    pub bytes: Vec<u8>,
    /// What the format could not hold.
    pub warnings: Vec<Warning>,
}

/// A file format of trajectories.
///
/// Contract: what [`Format::render`] writes, [`Format::parse`] reads back bit for bit, apart from what
/// the warnings of `render` name; and `parse` never panics, whatever the text.
pub trait Format: Sync {
    /// Name, e.g. `csv`.
    fn name(&self) -> &'static str;
    /// One line for people.
    fn doc(&self) -> &'static str;
    /// File extensions in lower case, without the dot; the first one is preferred.
    fn extensions(&self) -> &'static [&'static str];
    /// Whether a file is clearly of this format, where others have the same extension and it is not theirs alone.
    fn recognises(&self, bytes: &[u8]) -> bool {
        let _ = bytes;
        false
    }
    /// The bytes of the file at `path`, no more than `limit` + 1 of them: of a file with others beside it that belong to it, what all of
    /// them say.
    ///
    /// # Errors
    /// A missing or unreadable file, or a folder.
    fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        read_limited(path, limit, "trajectory")
    }
    /// The text that the other methods read: that of the file, or the table that is in a file which is no text.
    ///
    /// # Errors
    /// Bytes that are not UTF-8, or not a file of this format.
    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<String> {
        let _ = reading;
        decode_text(bytes)
    }
    /// Reads `text` as `reading` says; what it does not say is as this format has it.
    ///
    /// # Errors
    /// Anything that is not a trajectory in this format, with line and column.
    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed>;
    /// What of `reading` concerns this text: a mapping none of whose columns is there does not.
    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        let _ = text;
        Reading {
            columns: Columns::default(),
            only: None,
            skip_lines: None,
            rate_hz: None,
            topic: None,
            child_frame: None,
            ..reading.clone()
        }
    }
    /// In which order the columns of the quaternion stand, as they are read.
    fn order(&self, text: &str, reading: &Reading) -> QuaternionOrder {
        let _ = text;
        reading.quaternion.unwrap_or(QuaternionOrder::Wxyz)
    }
    /// The names of the columns, for formats that name them; none where the text has no such names.
    fn columns<'a>(&self, text: &'a str, reading: &Reading) -> Vec<&'a str> {
        let _ = (text, reading);
        Vec::new()
    }
    /// Reads every recording of a text that holds several: rows with the same values of `group_columns`, in order of
    /// first appearance, each with those values.
    ///
    /// # Errors
    /// As [`Format::parse`]; a column that is not there; a format that cannot hold several recordings.
    fn parse_groups(
        &self,
        text: &str,
        reading: &Reading,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        let _ = (text, reading, group_columns);
        Err(Error::invalid("files of this format hold one recording each").found(self.name()))
    }
    /// Whether files of this format are written here, too.
    fn writes(&self) -> bool {
        true
    }
    /// Writes a trajectory, in metres.
    ///
    /// # Errors
    /// A format whose files are only read ([`Format::writes`]).
    fn render(&self, trajectory: &Trajectory) -> Result<Rendered>;
}

impl std::fmt::Debug for dyn Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Format({})", self.name())
    }
}

/// Warnings about what files of a format that holds poses only cannot say of this trajectory.
pub(super) fn beyond_poses(files: &str, trajectory: &Trajectory) -> Vec<Warning> {
    let found = [
        (
            !trajectory.joints().is_empty(),
            "angles of joints, which are left out",
        ),
        (
            trajectory.velocities_world_m_s().is_some(),
            "velocities; they are left out",
        ),
        (
            trajectory.is_planar(),
            "that z is unknown; it is written as 0",
        ),
        (
            trajectory.orientations_world_from_body().is_none(),
            "that orientation is unknown; it is written as no rotation",
        ),
    ];
    let lost = found.into_iter().filter(|(is_lost, _)| *is_lost);
    lost.map(|(_, what)| not_written(files, what)).collect()
}

/// The warning that files of a format cannot say something.
pub(super) fn not_written(files: &str, what: &str) -> Warning {
    Code::NotWritten.warning(format!("{files} cannot say {what}"))
}
