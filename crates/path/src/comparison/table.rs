//! A table that compares several trajectories with one reference: one row per trajectory, one column per metric.

use std::path::PathBuf;

use serde::{Serialize, Serializer};

use super::association::Matched;
use super::basis::{Basis, Components};
use super::metric::{Context, Metric, Pair};
use super::registry::METRICS;
use crate::trajectory::{Prepared, Recording, prepare};
use realgap_core::unit::{LengthUnit, Unit, number};
use realgap_core::warning::{Code, Warning};

/// The comparison of one trajectory with the reference. It is serialised as one flat object, whose keys are the names of the fields and
/// the columns of the metrics.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Name of the trajectory (file stem).
    pub trajectory: String,
    /// Name of the reference.
    pub reference: String,
    /// Distance from the first to the last point of the trajectory, metres.
    pub net_displacement_m: f64,
    /// Number of components kept for the metric `pca`.
    pub pca_components: usize,
    /// Metric `pca` with 4 components (all components if there are fewer).
    pub pca_4_coefficients_m: f64,
    /// One distance per metric, in the order of the metrics.
    #[serde(flatten, serialize_with = "as_columns")]
    #[cfg_attr(
        feature = "schema",
        schemars(with = "std::collections::BTreeMap<String, f64>")
    )]
    pub distances: Vec<Distance>,
    /// Warnings that the reader should know; they are not a column.
    #[serde(skip)]
    pub warnings: Vec<Warning>,
}

/// A distance in the column of its metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Name of the column ([`Metric::column`]).
    pub column: &'static str,
    /// The distance in `unit`.
    pub value: f64,
    /// Unit of the distance ([`Metric::unit`]).
    pub unit: Unit,
}

impl Row {
    /// The distance in this column; `None` if no metric of the row has this column.
    pub fn distance(&self, column: &str) -> Option<f64> {
        let found = self.distances.iter().find(|d| d.column == column);
        found.map(|distance| distance.value)
    }
}

fn as_columns<S: Serializer>(distances: &[Distance], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(distances.iter().map(|d| (d.column, d.value)))
}

/// The metrics that need only positions, in the order of [`METRICS`]: the metrics of `realgap compare --metric all`.
pub fn position_metrics() -> Vec<&'static dyn Metric> {
    let mut metrics = METRICS.to_vec();
    metrics.retain(|metric| {
        let needs = metric.needs();
        !needs.orientation && !needs.body_length && !needs.spread && !needs.joints
    });
    metrics
}

/// Ratios of the sizes of two paths that suggest another unit of length in one of the files; robots themselves differ less.
const ANOTHER_UNIT: [(std::ops::Range<f64>, LengthUnit); 2] = [
    (50.0..200.0, LengthUnit::Centimetre),
    (300.0..3000.0, LengthUnit::Millimetre),
];
/// A path with a smaller extent is at rest, and gives no information about units, metres.
const STILL_M: f64 = 1e-4;

/// A reference and other recordings, all prepared, with a basis fitted to all of them.
#[derive(Debug, Clone)]
pub struct Comparison<'a> {
    reference: &'a Recording,
    others: &'a [Recording],
    reference_prepared: Prepared,
    others_prepared: Vec<Prepared>,
    basis: Basis,
    matched: &'a [Option<Matched>],
}

impl<'a> Comparison<'a> {
    /// Prepares the recordings and fits the basis on all of them.
    ///
    /// The reference is included in the fit; a recording that is given twice (the same file and group, or the same samples)
    /// is used once.
    ///
    /// # Errors
    /// A recording that cannot be prepared, or an invalid choice of components.
    pub fn new(
        reference: &'a Recording,
        others: &'a [Recording],
        components: Components,
    ) -> realgap_core::Result<Self> {
        let at_file = |recording: &'a Recording| {
            prepare(&recording.trajectory).map_err(|error| error.at_file(&recording.path))
        };
        let reference_prepared = at_file(reference)?;
        let others_prepared = others
            .iter()
            .map(at_file)
            .collect::<realgap_core::Result<Vec<_>>>()?;
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
            matched: &[],
        })
    }

    /// The same comparison with another basis, e.g. a saved one.
    #[must_use]
    pub fn with_basis(self, basis: Basis) -> Self {
        Self { basis, ..self }
    }

    /// The same comparison with matched samples of the reference and of each other recording, for metrics of samples
    /// ([`Synchronised::matched`](super::Synchronised)). Without them these metrics compare prepared points.
    #[must_use]
    pub fn with_matched(self, matched: &'a [Option<Matched>]) -> Self {
        Self { matched, ..self }
    }

    /// The basis: fitted to all distinct recordings, or given by [`Comparison::with_basis`].
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

    /// Warnings about paths whose sizes suggest different units of length.
    pub fn warnings(&self) -> Vec<Warning> {
        let extent_m = |recording: &Recording| recording.trajectory.extent_m();
        let reference_m = extent_m(self.reference);
        let unlike = self.others.iter().filter_map(|other| {
            let factor = extent_m(other) / reference_m;
            let size = factor.max(factor.recip());
            let unit = ANOTHER_UNIT.iter().find(|(sizes, _)| sizes.contains(&size));
            let (_, unit) = unit.filter(|_| extent_m(other).min(reference_m) > STILL_M)?;
            let ends = (other, self.reference);
            let (larger, smaller) = if factor > 1.0 { ends } else { (ends.1, ends.0) };
            Some(Code::UnlikelyLength.warning(format!(
                "{} goes {} times as far as {}: if its lengths are in {unit}, read it with `{}`",
                larger.name,
                number(size),
                smaller.name,
                larger.in_unit(*unit)
            )))
        });
        unlike.collect()
    }

    /// The pair of the reference and the other recording with this index; `None` beyond the last.
    pub fn pair(&self, index: usize) -> Option<Pair<'_>> {
        Some(Pair {
            real: &self.reference.trajectory,
            simulated: &self.others.get(index)?.trajectory,
            real_prepared: &self.reference_prepared,
            simulated_prepared: self.others_prepared.get(index)?,
            matched: self.matched.get(index).and_then(Option::as_ref),
        })
    }

    /// One row per other recording, in the given order, with a column for each of the metrics, e.g. [`position_metrics`].
    ///
    /// # Errors
    /// A metric that needs more than the two trajectories and their basis, or a distance that is not a finite number.
    pub fn rows(&self, metrics: &[&dyn Metric]) -> realgap_core::Result<Vec<Row>> {
        let pairs = (0..self.others.len()).filter_map(|index| self.pair(index));
        self.others
            .iter()
            .zip(pairs)
            .map(|(other, pair)| {
                self.row(other, &pair, metrics)
                    .map_err(|error| error.at_file(&other.path))
            })
            .collect()
    }

    fn row(
        &self,
        other: &Recording,
        pair: &Pair<'_>,
        metrics: &[&dyn Metric],
    ) -> realgap_core::Result<Row> {
        let context = Context {
            basis: Some(&self.basis),
            spread: None,
            body_length_m: None,
            channels: None,
        };
        let mut warnings: Vec<Warning> = Vec::new();
        let mut distances = Vec::with_capacity(metrics.len());
        for metric in metrics {
            let score = metric.compare(pair, &context)?;
            for warning in score.warnings {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            distances.push(Distance {
                column: metric.column(),
                value: score.value,
                unit: score.unit,
            });
        }
        Ok(Row {
            trajectory: other.name.clone(),
            reference: self.reference.name.clone(),
            net_displacement_m: pair.simulated_prepared.net_displacement_m(),
            pca_components: self.basis.kept(),
            pca_4_coefficients_m: self.basis.discrepancy_with_m(
                4,
                pair.real_prepared,
                pair.simulated_prepared,
            ),
            distances,
            warnings,
        })
    }
}

/// Compares `others` with `reference` by every position metric, at equal fractions of their durations; see [`Comparison`].
///
/// # Errors
/// The errors of [`Comparison::new`] and [`Comparison::rows`].
pub fn compare_all(
    reference: &Recording,
    others: &[Recording],
    components: Components,
) -> realgap_core::Result<Vec<Row>> {
    Comparison::new(reference, others, components)?.rows(&position_metrics())
}
