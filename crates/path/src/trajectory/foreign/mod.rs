//! Tables of other programs whose layout differs from a line of names above lines of numbers. Each is converted into such a table, whose
//! names state what the file states: bodies, axes, units. What the file does not state is then asked, as for any other table.

mod deeplabcut;
mod echo_csv;
mod flat;
mod franka;
mod grouped;
mod joint_rows;
mod json_lines;
mod motive;
mod north_east_down;
mod numpy;
mod opensim;
mod plotjuggler;
mod px4_csv;
mod qualisys;
mod text_table;
mod topic_echo;
mod vicon;

use std::path::Path;

use super::Trajectory;
use super::csv::Csv;
use super::format::{Decoded, Format, Parsed, Rendered};
use super::reading::{QuaternionOrder, Reading};
use super::relabel::relabelled;
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;

pub use deeplabcut::DEEPLABCUT;
pub use echo_csv::ECHO_CSV;
pub use franka::FRANKA;
pub use grouped::GROUPED;
pub use joint_rows::{JOINT_ROWS, NAMED_FIELDS};
pub use json_lines::JSON_LINES;
pub use motive::MOTIVE;
pub use north_east_down::NORTH_EAST_DOWN;
pub use numpy::{NPY, NPZ};
pub use opensim::{OPENSIM, TRC};
pub use plotjuggler::PLOTJUGGLER;
pub use px4_csv::PX4_CSV;
pub use qualisys::QUALISYS;
pub use text_table::TEXT_TABLE;
pub use topic_echo::TOPIC_ECHO;
pub use vicon::VICON;

/// A format of another program that is converted into a table with one line of names.
pub struct ForeignTable {
    pub(super) name: &'static str,
    pub(super) doc: &'static str,
    pub(super) extensions: &'static [&'static str],
    /// True if the first bytes of a file are those of this format.
    pub(super) recognises: fn(&[u8]) -> bool,
    /// The table in a file; the reading says which columns are to keep their names.
    pub(super) table: fn(Vec<u8>, &Reading) -> Result<Decoded>,
    /// Where other files may belong to a file: its bytes together with theirs, at most so many; `None` for a file that is alone.
    pub(super) beside: Option<Beside>,
}

/// Reads a file together with the files that belong to it.
pub(super) type Beside = fn(&Path, u64) -> Result<Option<Vec<u8>>>;

impl Format for ForeignTable {
    fn name(&self) -> &'static str {
        self.name
    }

    fn doc(&self) -> &'static str {
        self.doc
    }

    fn extensions(&self) -> &'static [&'static str] {
        self.extensions
    }

    fn recognises(&self, bytes: &[u8]) -> bool {
        (self.recognises)(bytes)
    }

    fn bytes(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let together = match self.beside {
            Some(read) => read(path, limit)?,
            None => None,
        };
        match together {
            Some(bytes) => Ok(bytes),
            None => read_limited(path, limit, "trajectory"),
        }
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let decoded = (self.table)(bytes, reading)?;
        Ok(Decoded {
            text: relabelled(decoded.text, reading)?,
            warnings: decoded.warnings,
        })
    }

    fn is_table(&self) -> bool {
        true
    }

    fn takes_header(&self) -> bool {
        self.name == TEXT_TABLE.name
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, reading)
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, reading)
    }

    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        Csv.applied(text, reading)
    }

    fn order(&self, text: &str, reading: &Reading) -> QuaternionOrder {
        Csv.order(text, reading)
    }

    fn columns<'a>(&self, text: &'a str, reading: &Reading) -> Vec<&'a str> {
        Csv.columns(text, reading)
    }

    fn parse_groups(
        &self,
        text: &str,
        reading: &Reading,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        Csv.parse_groups(text, reading, group_columns)
    }

    fn writes(&self) -> bool {
        false
    }

    fn render(&self, _trajectory: &Trajectory) -> Result<Rendered> {
        Err(
            Error::usage("files of this format can be read but not written")
                .found(self.name)
                .allowed("a .csv file"),
        )
    }
}
