//! An error together with the path of the value in the file that causes it.

use realgap_core::file::Source;
use realgap_core::{Error, range};

/// A checked value, or the error with its path.
pub(super) type Checked<T> = Result<T, Flaw>;

/// Path of the value in `defaults` if a module's field is left out and the default is used.
fn default_of(path: &str, source: &Source) -> Option<String> {
    let (_, field) = path.split_once("].kind.")?;
    let default = format!("defaults.{field}");
    Some(default).filter(|default| !source.has(path) && source.has(default))
}

/// An error in a blueprint and the path of the value in a RON file (`modules[2].kind.mass_kg`), from which line and column are
/// found if there is a file.
#[derive(Debug)]
pub(super) struct Flaw {
    path: String,
    error: Error,
}

impl Flaw {
    pub(super) fn new(path: impl Into<String>, error: Error) -> Self {
        Self {
            path: path.into(),
            error,
        }
    }

    #[must_use]
    pub(super) fn hint(self, hint: &str) -> Self {
        Self {
            error: self.error.hint(hint),
            ..self
        }
    }

    /// The list entry that contains the value: `bodies[2]` for `bodies[2].mass_kg`.
    pub(super) fn entry(&self) -> &str {
        let end = self.path.find(']').map_or(0, |end| end + 1);
        &self.path[..end]
    }

    /// The error for a blueprint that was not read from a file.
    pub(super) fn without_file(self) -> Error {
        self.error.field(self.path)
    }

    pub(super) fn in_file(self, source: &Source) -> Error {
        let path = default_of(&self.path, source).unwrap_or(self.path);
        let error = source.at(&path, self.error);
        error.field(path)
    }
}

/// The allowed range of a quantity; an error names the path of the value in the file.
pub(super) struct Range(range::Range);

impl Range {
    pub(super) fn within(low: f64, high: f64, unit: &'static str) -> Self {
        Self(range::Range::within(low, high, unit))
    }

    pub(super) fn above(low: f64, high: f64, unit: &'static str) -> Self {
        Self(range::Range::above(low, high, unit))
    }

    pub(super) fn check(&self, value: f64, at: &str) -> Checked<()> {
        let refusal = self.0.refusal(value);
        refusal.map_or(Ok(()), |error| Err(Flaw::new(at, error)))
    }
}
