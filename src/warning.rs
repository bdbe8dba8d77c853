//! Warnings are values: they travel with the result and are printed by the command line only.

use std::fmt;

/// Something the reader of a result should know; `code` is stable, `message` is for people.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Warning {
    /// Stable identifier, e.g. `undefined-heading`.
    pub code: &'static str,
    /// One sentence for people.
    pub message: String,
}

impl Warning {
    /// A warning with a stable `code` and one sentence for people.
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} [{}]", self.message, self.code)
    }
}
