//! Checks values of a file and makes errors that name their position in the file.

use realgap_core::error::{Error, Result};
use realgap_core::file::Source;
use realgap_core::range::Range;

/// The text of a file, for errors about its values.
pub(super) struct Reader<'a>(pub &'a Source);

impl Reader<'_> {
    pub(super) fn wrong(
        &self,
        field: &str,
        message: &str,
        found: impl std::fmt::Display,
        allowed: &str,
    ) -> Error {
        let error = Error::invalid(message.to_owned()).field(field);
        self.0.at(field, error.found(found).allowed(allowed))
    }

    pub(super) fn within(
        &self,
        field: &str,
        value: f64,
        low: f64,
        high: f64,
        unit: &'static str,
    ) -> Result<f64> {
        let checked = Range::within(low, high, unit).check(value, field);
        checked.map(|()| value).map_err(|e| self.0.at_field(e))
    }
}
