//! What was read at each distance, in numbers and in words.

use serde::Serialize;

use super::super::cell::Cell;
use super::super::fit::Fitted;
use super::super::peak::{Peak, described};
use realgap_core::statistics::{LEAST_FOR_NORMALITY, anderson_darling, mean, standard_deviation};
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};

/// What was read at one distance and one pair of angles, in one session.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistanceReport {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Angle of offset, degrees.
    pub offset_deg: f64,
    /// The session, where the log tells sessions apart.
    pub session: Option<String>,
    /// Readings that came and are no outliers.
    pub readings: usize,
    /// How many of these differ.
    pub different: usize,
    /// Where they crowd, if in several places: rising.
    pub peaks: Vec<Peak>,
    /// Readings that have nothing to do with the distance.
    pub outliers: usize,
    /// Readings that never came.
    pub dropouts: usize,
    /// Mean of the readings.
    pub mean: Option<f64>,
    /// This is the standard deviation of the readings.
    pub sd: Option<f64>,
    /// Mean less the model's.
    pub residual: Option<f64>,
    /// Standard deviation over the model's.
    pub sd_ratio: Option<f64>,
    /// This is the p value of the Anderson–Darling test of normality, where there are enough readings.
    pub normality_p: Option<f64>,
}

/// How many distances are normal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Normality {
    /// Distances with enough readings.
    pub tested: usize,
    /// How many of these tests have p below 5 %; one in twenty by chance.
    pub rejected: usize,
    /// Smallest p value times the number of tests (Bonferroni), at most 1.
    pub adjusted_p: f64,
}

/// Readings that come in steps as wide as they spread, or crowd in several places, in words.
pub(super) fn crowds(distances: &[DistanceReport], step: f64, unit: &str) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let many: Vec<&DistanceReport> = distances.iter().filter(|d| d.readings >= FEW).collect();
    let is_rounded = |d: &&&DistanceReport| d.sd.is_some_and(|sd| step > ROUNDED * sd);
    let rounded = many.iter().filter(is_rounded).count();
    if rounded > 0 {
        let alone = many.iter().filter(|d| d.different == 1).count();
        warnings.push(Code::QuantisedReadings.warning(format!(
            "readings come in steps of {} {unit}, more than half of what they spread at {rounded} of {} distances; at {alone} all are the same: the spread there is at least that of rounding",
            number(step),
            many.len()
        )));
    }
    let crowded: Vec<&DistanceReport> = distances.iter().filter(|d| !d.peaks.is_empty()).collect();
    if let Some(most) = crowded
        .iter()
        .max_by(|a, b| least_share(a).total_cmp(&least_share(b)))
    {
        let peaks: Vec<String> = most
            .peaks
            .iter()
            .map(|p| format!("{} ({:.0} %)", number(p.centre), 100.0 * p.share))
            .collect();
        warnings.push(Code::SeveralPeaks.warning(format!(
            "readings crowd in several places at {} of {} distances, e.g. at {}: {} {unit}; one normal spread holds all of them",
            crowded.len(),
            distances.len(),
            most.distance,
            peaks.join(", ")
        )));
    }
    warnings
}

/// Fewest readings that steps are told of.
const FEW: usize = 5;
/// Steps count from this share of the spread on.
const ROUNDED: f64 = 0.5;

fn least_share(report: &DistanceReport) -> f64 {
    let shares = report.peaks.iter().map(|p| p.share);
    shares.fold(1.0, f64::min)
}

pub(super) fn report(
    cell: &Cell,
    fitted: &Fitted,
    session: Option<&String>,
    resolution: f64,
) -> DistanceReport {
    let readings = cell.values.len();
    let centre = (readings > 0).then(|| mean(&cell.values));
    let sd = (readings > 1).then(|| standard_deviation(&cell.values));
    let model_mean = fitted.mean.at(cell.distance)
        + fitted.incidence_per_deg * cell.incidence_deg
        + fitted.offset_per_deg * cell.offset_deg;
    let tested = (readings >= LEAST_FOR_NORMALITY)
        .then(|| anderson_darling(&cell.values).ok())
        .flatten();
    DistanceReport {
        distance: cell.distance,
        incidence_deg: cell.incidence_deg,
        offset_deg: cell.offset_deg,
        session: session.cloned(),
        readings,
        different: different(&cell.values),
        peaks: described(&cell.values, resolution),
        outliers: cell.outliers.len(),
        dropouts: cell.dropouts,
        mean: centre,
        sd,
        residual: centre.map(|m| m - model_mean),
        sd_ratio: sd.map(|s| s / fitted.spread.at(cell.distance)),
        normality_p: tested.map(|test| test.p_value),
    }
}

fn different(values: &[f64]) -> usize {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted.len()
}

pub(super) fn normality(distances: &[DistanceReport]) -> Normality {
    let p: Vec<f64> = distances.iter().filter_map(|d| d.normality_p).collect();
    let least = p.iter().copied().fold(1.0, f64::min);
    Normality {
        tested: p.len(),
        rejected: p.iter().filter(|p| **p < 0.05).count(),
        adjusted_p: (least * p.len().max(1) as f64).min(1.0),
    }
}
