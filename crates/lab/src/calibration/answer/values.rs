//! Files of parameter values, such as the `best.ron` of a sweep, which every command with `--parameters` reads.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use realgap_core::file::{Source, parse_ron, unique_keys};
use realgap_core::{Error, Result};
use realgap_simulation::parameter::{Assignment, ParameterSet};

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
    /// What the fit left possible: of each parameter one value a draw, in the same order.
    #[serde(
        default,
        skip_serializing_if = "BTreeMap::is_empty",
        deserialize_with = "unique_keys"
    )]
    pub draws: BTreeMap<String, Vec<f64>>,
    /// The recordings that they were fitted on ([`recording_id`](crate::calibration::recording_id)); those held out are not among them.
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

/// What files of parameters say together.
#[derive(Debug, Clone, Default)]
pub struct Fitted {
    /// The values.
    pub values: ParameterSet,
    /// What the fits left possible, a group a file that has draws; what is fixed after that file is not among them.
    pub draws: Vec<Vec<ParameterSet>>,
    /// The recordings that they were fitted on.
    pub fitted_on: Vec<String>,
}

impl Fitted {
    /// What these files say, later ones over earlier ones.
    ///
    /// # Errors
    /// As [`read_parameters`].
    pub fn read(files: &[impl AsRef<Path>]) -> Result<Self> {
        let mut all = files.iter().map(read_best);
        all.try_fold(Self::default(), |before, after| Ok(before.with(after?)))
    }

    /// These, and then values that hold against them.
    #[must_use]
    pub fn with_values(self, values: &ParameterSet) -> Self {
        self.with(Self {
            values: values.clone(),
            ..Self::default()
        })
    }

    fn with(mut self, after: Self) -> Self {
        for draw in self.draws.iter_mut().flatten() {
            let left = draw
                .iter()
                .filter(|a| after.values.value(a.parameter.name).is_none());
            *draw = left.copied().collect();
        }
        self.draws
            .retain(|group| group.iter().any(|draw| !draw.is_empty()));
        self.draws.extend(after.draws);
        self.fitted_on.extend(after.fitted_on);
        self.values = self.values.with_all(&after.values);
        self
    }
}

/// Reads the values of a parameter file.
///
/// # Errors
/// A missing or malformed file, unknown parameters, values out of bounds, draws of which one parameter has more than another.
pub fn read_parameters(path: impl AsRef<Path>) -> Result<ParameterSet> {
    read_best(path).map(|fitted| fitted.values)
}

/// Reads all of a parameter file.
///
/// # Errors
/// As [`read_parameters`].
pub fn read_best(path: impl AsRef<Path>) -> Result<Fitted> {
    let source = Source::read(path, "parameters")?;
    let file: BestFile = parse_ron(&source)?;
    let values = assignments(&file.parameters).map_err(|e| source.at("parameters", e))?;
    let count = file.draws.values().map(Vec::len).max().unwrap_or(0);
    let draw = |index: usize| -> Result<ParameterSet> {
        let row = file
            .draws
            .iter()
            .map(|(name, values)| match values.get(index) {
                Some(value) => Ok((name.clone(), *value)),
                None => Err(Error::invalid("a draw is missing")
                    .field(name)
                    .found(format!("{} draws", values.len()))
                    .allowed(format!("{count}, as many as every parameter has"))),
            });
        assignments(&row.collect::<Result<_>>()?)
    };
    let draws: Result<Vec<ParameterSet>> = (0..count).map(draw).collect();
    let draws = draws.map_err(|e| source.at("draws", e))?;
    Ok(Fitted {
        values,
        draws: Some(draws)
            .filter(|draws| !draws.is_empty())
            .into_iter()
            .collect(),
        fitted_on: file.fitted_on,
    })
}

/// Checked values of parameters.
pub(in crate::calibration) fn assignments(values: &BTreeMap<String, f64>) -> Result<ParameterSet> {
    let values = values.iter();
    values
        .map(|(name, value)| Assignment::new(name, *value))
        .collect()
}
