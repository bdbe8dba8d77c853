//! A basis as it is written to disk, checked when it comes back.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::basis::{Basis, VECTOR, dot};
use crate::error::{Error, Result};
use crate::file::Source;

/// The kept part of a [`Basis`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedBasis {
    trajectories: usize,
    explained_variance_ratio: Vec<f64>,
    mean_m: Vec<f64>,
    components: Vec<Vec<f64>>,
}

impl Basis {
    /// A basis as JSON: `basis.json` of a results folder, or what `realgap compare` was told to save.
    ///
    /// # Errors
    /// A text that is no such basis.
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
