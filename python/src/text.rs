//! Everything but arrays is passed between Rust and Python as JSON: numbers keep their bits in both directions.

use realgap::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A value as JSON.
///
/// # Errors
/// None for the values of this crate.
pub fn to_text(value: &impl Serialize) -> Result<String> {
    serde_json::to_string(value).map_err(|e| Error::invalid(format!("cannot write JSON: {e}")))
}

/// Parses keyword arguments, whose names the Python half has checked.
///
/// # Errors
/// A value of the wrong kind, or out of range.
pub fn of_text<T: DeserializeOwned>(what: &str, text: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|error| {
        let said = error.to_string();
        let said = said
            .rsplit_once(" at line ")
            .map_or(&*said, |(said, _)| said);
        Error::usage(format!("{what}: {said}"))
    })
}
