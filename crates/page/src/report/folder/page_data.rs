//! The data of a page that no other file of a results folder holds: the command, recorded paths, a replay of the best.

use std::path::Path;

use crate::report::folder::tree::read_json;
use crate::report::replay::motion::ShownScene;
use crate::results::kind::file;
use realgap_core::error::{Advice, Error, ErrorKind, Result};
use realgap_core::file::{SEAL_FILE, Seal, write_sealed};
use realgap_core::text::escaped_json;
use serde::{Deserialize, Serialize};

/// The largest number of recorded paths in a page: more could not be distinguished in a picture.
pub const SHOWN_RECORDINGS: usize = 12;

/// Name of the page in a results folder.
pub const PAGE_FILE: &str = file::PAGE[0];

/// What a command writes for the page of its results folder, beside the other files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PageData {
    /// The command that makes the results again.
    pub command: String,
    /// Commands that use the results, each with what it is for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub next: Vec<NextCommand>,
    /// Length of the simulated runs, seconds.
    pub duration_s: f64,
    /// What recorded paths are: `reality`, or a stand-in for it.
    pub reality: String,
    /// Recorded paths that the first simulation of a point is compared with, at most [`SHOWN_RECORDINGS`].
    pub recorded: Vec<RecordedPath>,
    /// The best point's path, prepared, metres: an optimizer's best need not be one of the stored points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub best_xy_m: Vec<[f64; 2]>,
    /// The best in motion.
    pub replay: Option<ReplayData>,
}

/// A command that uses the results of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct NextCommand {
    /// What it is for, as a sentence.
    pub purpose: String,
    /// The command.
    pub command: String,
}

/// A path as it is compared: from the origin, net displacement along +x, points at equal steps of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RecordedPath {
    /// Name of the recording.
    pub name: String,
    /// How long it lasts, seconds.
    pub duration_s: f64,
    /// Its points, prepared, metres.
    pub xy_m: Vec<[f64; 2]>,
}

/// A robot in motion, as the page's scripts read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ReplayData {
    /// Robot, floor, names of the runs.
    pub scene: ShownScene,
    /// Their motion: base64.
    pub motion: String,
}

impl PageData {
    /// Name of the file.
    pub const FILE: &'static str = file::PAGE[1];

    /// Writes it into the folder.
    ///
    /// # Errors
    /// A full disk or an unwritable folder.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let json = serde_json::to_string(self)
            .map(escaped_json)
            .map_err(|e| Error::invalid(format!("cannot write JSON: {e}")))?;
        write_sealed(
            &folder.join(Self::FILE),
            format!("{json}\n").as_bytes(),
            true,
        )
    }

    /// The data in a folder; `None` where no command has written any.
    ///
    /// # Errors
    /// A file that cannot be read, or that holds something else; a file that was written and is gone: without its paths and its
    /// replay, the page would be a third of what it was.
    pub(in crate::report) fn read(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(Self::FILE);
        if !path.is_file() {
            return match Seal::read(folder)? {
                Some(seal) if seal.has(Self::FILE) => Err(Error::conflict(
                    "the recorded paths and the replay of the page are gone",
                )
                .at_file(&path)
                .found("no such file")
                .allowed(format!("the file that {SEAL_FILE} lists"))
                .hint("run the command that wrote the folder again: it keeps its runs")
                .advise(Advice::AcceptFiles)),
                _ => Ok(None),
            };
        }
        let data: Self =
            read_json(&path, "the data of a page").map_err(|error| match error.kind() {
                ErrorKind::Invalid => error
                    .hint("remove the file: the page is made without it")
                    .advise(Advice::AcceptFiles),
                _ => error,
            })?;
        // It stands inside of a script element as it is.
        let is_base64 = |c: char| c.is_ascii_alphanumeric() || "+/=".contains(c);
        let foreign = data
            .replay
            .as_ref()
            .is_some_and(|replay| !replay.motion.chars().all(is_base64));
        if foreign {
            return Err(Error::invalid("a motion is base64")
                .at_file(&path)
                .field("replay.motion"));
        }
        Ok(Some(data))
    }
}

/// The recorded paths, if there are data.
pub(in crate::report) fn recorded_of(data: Option<&PageData>) -> &[RecordedPath] {
    data.map_or(&[], |data| data.recorded.as_slice())
}
