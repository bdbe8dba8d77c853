//! What an export format is.

use super::robot::Robot;
use realgap_core::warning::Warning;

/// A robot as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The whole file.
    pub text: String,
    /// What the format cannot carry.
    pub warnings: Vec<Warning>,
    /// Files that it names, which belong beside it: name and contents.
    pub files: Vec<(String, Vec<u8>)>,
}

/// A file format of robots that other programs read.
///
/// Contract: every morphology can be rendered; the text is well formed; masses are complete; every
/// warning is also a comment in the text.
pub trait Format: Sync {
    /// Name, e.g. `mjcf`.
    fn name(&self) -> &'static str;
    /// One line for people.
    fn doc(&self) -> &'static str;
    /// Writes the robot.
    fn render(&self, robot: &Robot<'_>) -> Exported;
}

impl std::fmt::Debug for dyn Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Format({})", self.name())
    }
}
