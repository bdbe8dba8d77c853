//! Every position metric of several trajectories against one reference.

use std::path::PathBuf;

use serde::Serialize;

use super::basis::{Basis, Components};
use super::evo::{Ape, Rpe, UmeyamaApe};
use super::metric::{Context, Metric, Pair};
use super::pointwise::{Displacement, Rms};
use super::shape::{Dtw, Frechet, Hausdorff};
use super::{Pca, PcaCluster};
use crate::error::Result;
use crate::trajectory::{Prepared, Recording, prepare};
use crate::warning::Warning;

/// One trajectory against the reference: all distances in metres. The names of the fields are the names of the columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Name of the trajectory (file stem).
    pub trajectory: String,
    /// Name of the reference.
    pub reference: String,
    /// Distance from its first to its last point.
    pub net_displacement_m: f64,
    /// Metric `displacement`.
    pub displacement_error_m: f64,
    /// Number of components kept for `pca_coefficients_m`.
    pub pca_components: usize,
    /// Metric `pca`.
    pub pca_coefficients_m: f64,
    /// Metric `pca` with 4 components (all there are, if fewer).
    pub pca_4_coefficients_m: f64,
    /// Metric `pca-cluster`.
    pub pca_cluster_m: f64,
    /// Metric `rms`.
    pub rms_m: f64,
    /// Metric `hausdorff`.
    pub hausdorff_m: f64,
    /// Metric `frechet`.
    pub discrete_frechet_m: f64,
    /// Metric `dtw`.
    pub dtw_sum_m: f64,
    /// Metric `ape`.
    pub ape_rmse_m: f64,
    /// Metric `umeyama-ape`.
    pub umeyama_ape_rmse_m: f64,
    /// Metric `rpe`.
    pub rpe_rmse_m: f64,
    /// What the reader should know; not a column.
    #[serde(skip)]
    pub warnings: Vec<Warning>,
}

/// Recordings prepared together, with the basis of all of them.
#[derive(Debug, Clone)]
pub struct Comparison<'a> {
    reference: &'a Recording,
    others: &'a [Recording],
    reference_prepared: Prepared,
    others_prepared: Vec<Prepared>,
    basis: Basis,
}

impl<'a> Comparison<'a> {
    /// Prepares the recordings and fits the basis on all of them.
    ///
    /// The reference belongs to the basis; a recording given twice (the same file and group, or the same samples)
    /// counts once.
    ///
    /// # Errors
    /// A recording that cannot be prepared, or a choice of components that makes no sense.
    pub fn new(
        reference: &'a Recording,
        others: &'a [Recording],
        components: Components,
    ) -> Result<Self> {
        let at_file = |recording: &'a Recording| {
            prepare(&recording.trajectory).map_err(|error| error.at_file(&recording.path))
        };
        let reference_prepared = at_file(reference)?;
        let others_prepared = others.iter().map(at_file).collect::<Result<Vec<_>>>()?;
        let mut distinct: Vec<(&Recording, Option<PathBuf>)> = Vec::new();
        let mut in_basis = Vec::new();
        let all = std::iter::once((reference, &reference_prepared))
            .chain(others.iter().zip(&others_prepared));
        for (recording, prepared) in all {
            let file = recording.path.canonicalize().ok();
            let known = distinct.iter().any(|(other, other_file)| {
                let same_file = file.is_some() && *other_file == file;
                (same_file && other.name == recording.name)
                    || other.trajectory == recording.trajectory
            });
            if !known {
                distinct.push((recording, file));
                in_basis.push(prepared);
            }
        }
        let basis = Basis::fit(&in_basis, components)?;
        Ok(Self {
            reference,
            others,
            reference_prepared,
            others_prepared,
            basis,
        })
    }

    /// The basis of all distinct recordings.
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// The reference, prepared.
    pub fn reference_prepared(&self) -> &Prepared {
        &self.reference_prepared
    }

    /// The other recordings, prepared, in the order given.
    pub fn others_prepared(&self) -> &[Prepared] {
        &self.others_prepared
    }

    /// Pair number `index`: the reference and one of the others; `None` beyond the last.
    pub fn pair(&self, index: usize) -> Option<Pair<'_>> {
        Some(Pair {
            real: &self.reference.trajectory,
            simulated: &self.others.get(index)?.trajectory,
            real_prepared: &self.reference_prepared,
            simulated_prepared: self.others_prepared.get(index)?,
        })
    }

    /// One row per other recording, in the order given.
    ///
    /// # Errors
    /// A distance that is not a finite number.
    pub fn rows(&self) -> Result<Vec<Row>> {
        let pairs = (0..self.others.len()).filter_map(|index| self.pair(index));
        self.others
            .iter()
            .zip(pairs)
            .map(|(other, pair)| {
                self.row(other, &pair)
                    .map_err(|error| error.at_file(&other.path))
            })
            .collect()
    }

    fn row(&self, other: &Recording, pair: &Pair<'_>) -> Result<Row> {
        let context = Context {
            basis: Some(&self.basis),
            body_length_m: None,
        };
        let mut warnings: Vec<Warning> = Vec::new();
        let mut value = |metric: &dyn Metric| {
            metric.compare(pair, &context).map(|score| {
                for warning in score.warnings {
                    if !warnings.contains(&warning) {
                        warnings.push(warning);
                    }
                }
                score.value
            })
        };
        Ok(Row {
            trajectory: other.name.clone(),
            reference: self.reference.name.clone(),
            net_displacement_m: pair.simulated_prepared.net_displacement_m(),
            displacement_error_m: value(&Displacement)?,
            pca_components: self.basis.kept(),
            pca_coefficients_m: value(&Pca)?,
            pca_4_coefficients_m: self.basis.discrepancy_with_m(
                4,
                pair.real_prepared,
                pair.simulated_prepared,
            ),
            pca_cluster_m: value(&PcaCluster)?,
            rms_m: value(&Rms)?,
            hausdorff_m: value(&Hausdorff)?,
            discrete_frechet_m: value(&Frechet)?,
            dtw_sum_m: value(&Dtw)?,
            ape_rmse_m: value(&Ape)?,
            umeyama_ape_rmse_m: value(&UmeyamaApe)?,
            rpe_rmse_m: value(&Rpe)?,
            warnings,
        })
    }
}

/// Every position metric of `others` against `reference`; see [`Comparison`].
///
/// # Errors
/// As [`Comparison::new`] and [`Comparison::rows`].
pub fn compare_all(
    reference: &Recording,
    others: &[Recording],
    components: Components,
) -> Result<Vec<Row>> {
    Comparison::new(reference, others, components)?.rows()
}
