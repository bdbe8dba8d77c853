//! Parameter values in a file: the `best.ron` of a sweep, readable wherever `--parameters` is.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::study_file::assignments;
use realgap_core::error::Result;
use realgap_core::file::{Source, parse_ron, unique_keys};
use realgap_engine::parameter::ParameterSet;

/// Values with where they come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Parameters")]
pub struct BestFile {
    /// What these values are, for people.
    #[serde(default)]
    pub description: String,
    /// The study that they were fitted in, relative to this file: where this file stands in place of a study, that one is
    /// read, with these values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<PathBuf>,
    /// Name and value of each parameter.
    #[serde(deserialize_with = "unique_keys")]
    pub parameters: BTreeMap<String, f64>,
    /// The recordings that they were fitted on ([`recording_id`](super::recording_id)); those held out are not among them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fitted_on: Vec<String>,
}

/// Values by the names of their parameters.
pub(crate) fn by_name(set: &ParameterSet) -> BTreeMap<String, f64> {
    let values = set.iter();
    values
        .map(|a| (a.parameter.name.to_owned(), a.value))
        .collect()
}

/// The study that a parameter file names, from the current folder; `None` for any other file.
pub fn study_of(path: impl AsRef<Path>) -> Option<PathBuf> {
    let path = path.as_ref();
    let source = Source::read(path, "parameters").ok()?;
    let file: BestFile = parse_ron(&source).ok()?;
    Some(path.parent().unwrap_or(Path::new("")).join(file.study?))
}

/// Reads the values of a parameter file.
///
/// # Errors
/// A missing or malformed file, unknown parameters, values out of bounds.
pub fn read_parameters(path: impl AsRef<Path>) -> Result<ParameterSet> {
    read_best(path).map(|(values, _)| values)
}

/// Reads the values of a parameter file, and which recordings they were fitted on.
///
/// # Errors
/// As [`read_parameters`].
pub fn read_best(path: impl AsRef<Path>) -> Result<(ParameterSet, Vec<String>)> {
    let source = Source::read(path, "parameters")?;
    let file: BestFile = parse_ron(&source)?;
    let values = assignments(&file.parameters).map_err(|e| source.at("parameters", e))?;
    Ok((values, file.fitted_on))
}
