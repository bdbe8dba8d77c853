//! The file format of a saved basis, which is checked when it is read.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::basis::{Basis, VECTOR, dot};
use realgap_core::error::{Error, Result};
use realgap_core::file::{SCHEMA_VERSION, Source};

/// The saved part of a [`Basis`]: its kept components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SavedBasis {
    /// Version of the format; a file without it has version 1.
    #[serde(default = "first_form")]
    schema_version: u32,
    /// Number of trajectories to which the basis was fitted.
    trajectories: usize,
    /// Share of the variance that each component explains.
    explained_variance_ratio: Vec<f64>,
    /// The mean trajectory: x of all points, then y of all points, metres.
    mean_m: Vec<f64>,
    /// The kept components; each has as many numbers as the mean.
    components: Vec<Vec<f64>>,
}

fn first_form() -> u32 {
    1
}

impl Basis {
    /// Parses a basis from JSON: `basis.json` of a results folder, or a basis that `realgap compare` has saved.
    ///
    /// # Errors
    /// A text that is not a saved basis.
    pub fn parse(source: &Source) -> Result<Self> {
        serde_json::from_str(source.text()).map_err(|e| {
            Error::invalid(format!("not a saved basis: {e}"))
                .at_file(source.path())
                .allowed("basis.json of a results folder, or a basis saved by a comparison")
        })
    }
}

impl Serialize for Basis {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let saved = SavedBasis {
            schema_version: SCHEMA_VERSION,
            trajectories: self.trajectories,
            explained_variance_ratio: self.explained_variance_ratio.clone(),
            mean_m: self.mean_m.clone(),
            components: self.components[..self.kept].to_vec(),
        };
        saved.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Basis {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let saved = SavedBasis::deserialize(deserializer)?;
        Self::try_from(saved).map_err(serde::de::Error::custom)
    }
}

impl TryFrom<SavedBasis> for Basis {
    type Error = Error;

    fn try_from(saved: SavedBasis) -> Result<Self> {
        if saved.schema_version != SCHEMA_VERSION {
            return Err(Error::invalid("a basis of another version")
                .field("schema_version")
                .found(saved.schema_version)
                .allowed(SCHEMA_VERSION.to_string()));
        }
        let long_enough = |v: &Vec<f64>| v.len() == VECTOR && v.iter().all(|x| x.is_finite());
        if !long_enough(&saved.mean_m) || !saved.components.iter().all(long_enough) {
            return Err(Error::invalid("not a basis of this version")
                .allowed(format!("vectors of {VECTOR} finite numbers")));
        }
        if saved.components.len() > saved.explained_variance_ratio.len() {
            return Err(Error::invalid("a component has no share of the variance")
                .field("explained_variance_ratio")
                .found(saved.explained_variance_ratio.len())
                .allowed(format!("at least {}", saved.components.len())));
        }
        for (index, a) in saved.components.iter().enumerate() {
            for (other, b) in saved.components[..=index].iter().enumerate() {
                let expected = if index == other { 1.0 } else { 0.0 };
                if (dot(a, b) - expected).abs() > 1e-6 {
                    return Err(Error::invalid("the components are not orthonormal")
                        .field(format!("components[{index}]"))
                        .hint("the file has been changed; fit the basis again"));
                }
            }
        }
        Ok(Self {
            kept: saved.components.len(),
            mean_m: saved.mean_m,
            components: saved.components,
            explained_variance_ratio: saved.explained_variance_ratio,
            trajectories: saved.trajectories,
        })
    }
}
