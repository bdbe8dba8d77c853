//! Parameter values in a file: the `best.ron` of a sweep, readable wherever `--parameters` is.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::file::{Source, parse_ron, unique_keys};
use crate::simulation::parameter::{Assignment, ParameterSet};

/// Values with where they come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "Parameters")]
pub struct BestFile {
    /// What these values are, for people.
    #[serde(default)]
    pub description: String,
    /// Name and value of each parameter.
    #[serde(deserialize_with = "unique_keys")]
    pub parameters: BTreeMap<String, f64>,
}

/// Reads the values of a parameter file.
///
/// # Errors
/// A missing or malformed file, unknown parameters, values out of bounds.
pub fn read_parameters(path: impl AsRef<Path>) -> Result<ParameterSet> {
    let source = Source::read(path, "parameters")?;
    let file: BestFile = parse_ron(&source)?;
    file.parameters
        .iter()
        .map(|(name, value)| Assignment::new(name, *value).map_err(|e| source.at("parameters", e)))
        .collect()
}
