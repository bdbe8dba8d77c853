//! The trait of export formats, and the type of an exported robot.

use super::robot::Robot;
use realgap_core::warning::Warning;

/// An exported robot: the text of its file, warnings, and additional files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The whole file.
    pub text: String,
    /// Warnings about everything that the format cannot represent.
    pub warnings: Vec<Warning>,
    /// Files that the text refers to and that belong beside it: name and contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// A file format for robots that other programs can read.
///
/// Contract: every morphology can be exported; the text is well formed; the masses are complete; every warning is also a comment
/// in the text.
pub trait Format: Sync {
    /// Name, e.g. `mjcf`.
    fn name(&self) -> &'static str;
    /// Description of the format in one line.
    fn doc(&self) -> &'static str;
    /// Converts the robot into the format.
    fn render(&self, robot: &Robot<'_>) -> Exported;
}

impl std::fmt::Debug for dyn Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Format({})", self.name())
    }
}
