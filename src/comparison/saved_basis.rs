//! A basis as it is written to disk, checked when it comes back.

use serde::{Deserialize, Serialize};

use super::basis::{Basis, VECTOR, dot};
use crate::error::{Error, Result};

/// The kept part of a [`Basis`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SavedBasis {
    trajectories: usize,
    explained_variance_ratio: Vec<f64>,
    mean_m: Vec<f64>,
    components: Vec<Vec<f64>>,
}

impl From<Basis> for SavedBasis {
    fn from(basis: Basis) -> Self {
        let mut components = basis.components;
        components.truncate(basis.kept);
        Self {
            trajectories: basis.trajectories,
            explained_variance_ratio: basis.explained_variance_ratio,
            mean_m: basis.mean_m,
            components,
        }
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
