//! A run with its name and metadata: what was recorded, from what, by whom.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Reading, Trajectory};
use realgap_core::warning::Warning;

/// Where the motion in a recording comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Source {
    /// Measured on a real robot.
    Real,
    /// Made by a simulator (another engine, or hidden parameters) in place of a real run.
    StandIn,
}

impl Source {
    /// Where several recordings come from: stand-ins as soon as one of them is, for then their answer is no answer about
    /// hardware. Recordings that do not say are taken for real ones.
    pub fn of<'a>(recordings: impl IntoIterator<Item = &'a Recording>) -> Self {
        let mut metas = recordings.into_iter().filter_map(|r| r.meta.as_ref());
        if metas.any(|meta| meta.source == Self::StandIn) {
            Self::StandIn
        } else {
            Self::Real
        }
    }

    /// What stands in a picture's legend for what was recorded.
    pub fn reality_label(self) -> &'static str {
        match self {
            Self::Real => "reality",
            Self::StandIn => "stand-in for reality",
        }
    }

    /// What recordings are called in a caption.
    pub fn recordings_label(self) -> &'static str {
        match self {
            Self::Real => "recordings",
            Self::StandIn => "stand-in recordings, not hardware",
        }
    }
}

/// Metadata of a set of recordings, from `meta.ron` beside the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Meta {
    /// Name of the robot (a morphology), e.g. `tripod`.
    pub robot: String,
    /// Real or stand-in.
    pub source: Source,
    /// How, where and by whom it was recorded; the command for a stand-in.
    pub description: String,
    /// Frame of the poses, e.g. "world, z up; pose of the core's centre".
    pub frame: String,
    /// Licence of the data.
    pub licence: String,
    /// How the files are read, where they are not written as here.
    #[serde(default, skip_serializing_if = "Reading::is_usual")]
    pub reading: Reading,
}

/// One recorded run.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// File stem (or `stem/group` for one group of a long-format file).
    pub name: String,
    /// The file it was read from.
    pub path: PathBuf,
    /// The motion.
    pub trajectory: Trajectory,
    /// The motions of other bodies in the same file, by name: columns `NAME_x_m` and so on.
    pub bodies: Vec<(String, Trajectory)>,
    /// Metadata, where a `meta.ron` lies beside the file.
    pub meta: Option<Meta>,
    /// How the file was read.
    pub reading: Reading,
    /// What the reader should know (columns ignored, quaternions renormalised).
    pub warnings: Vec<Warning>,
}
