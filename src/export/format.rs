//! What an export format is, and the registry of all of them.

use super::mjcf::Mjcf;
use super::robot::Robot;
use super::urdf::Urdf;
use crate::error::{Error, Result};
use crate::warning::Warning;

/// A robot as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exported {
    /// The whole file.
    pub text: String,
    /// What the format cannot carry.
    pub warnings: Vec<Warning>,
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

/// Every known format.
pub const FORMATS: &[&dyn Format] = &[&Mjcf, &Urdf];

/// The format called `name`.
///
/// # Errors
/// An unknown name.
pub fn format_named(name: &str) -> Result<&'static dyn Format> {
    FORMATS
        .iter()
        .copied()
        .find(|format| format.name() == name)
        .ok_or_else(|| {
            let known: Vec<&str> = FORMATS.iter().map(|format| format.name()).collect();
            Error::invalid("unknown export format")
                .found(name)
                .allowed(known.join(", "))
        })
}
