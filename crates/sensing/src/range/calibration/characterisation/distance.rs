//! Statistics of the readings at each distance, and warnings about rounding and several peaks.

use serde::Serialize;

use super::super::cell::Cell;
use super::super::fit::Fitted;
use super::super::peak::{Peak, described};
use realgap_core::statistics::{LEAST_FOR_NORMALITY, anderson_darling, mean, standard_deviation};
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};

/// Statistics of the readings at one distance and one pair of angles, in one session.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistanceReport {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Angle of incidence, degrees.
    pub incidence_deg: f64,
    /// Angle of offset, degrees.
    pub offset_deg: f64,
    /// The session, if the log names sessions.
    pub session: Option<String>,
    /// Number of readings without dropouts and outliers.
    pub readings: usize,
    /// Number of different values among these readings.
    pub different: usize,
    /// Peaks of the distribution of readings in rising order, if there are several.
    pub peaks: Vec<Peak>,
    /// Number of readings that have nothing to do with the distance.
    pub outliers: usize,
    /// Number of dropouts.
    pub dropouts: usize,
    /// Mean of the readings.
    pub mean: Option<f64>,
    /// Standard deviation of the readings.
    pub sd: Option<f64>,
    /// Mean of the readings minus the mean of the model.
    pub residual: Option<f64>,
    /// Standard deviation of the readings divided by that of the model.
    pub sd_ratio: Option<f64>,
    /// p value of the Anderson–Darling test of normality; `None` for too few readings.
    pub normality_p: Option<f64>,
}

/// Results of the tests of normality at all distances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Normality {
    /// Number of distances with enough readings for a test.
    pub tested: usize,
    /// Number of tests with p below 5 %; by chance alone one in twenty.
    pub rejected: usize,
    /// Smallest p value times the number of tests (Bonferroni), at most 1.
    pub adjusted_p: f64,
}

/// Warnings if readings are rounded to steps that are wide compared with their standard deviation, or if they have several peaks.
pub(super) fn reading_warnings(
    distances: &[DistanceReport],
    step: f64,
    unit: &str,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let many: Vec<&DistanceReport> = distances.iter().filter(|d| d.readings >= FEW).collect();
    let is_rounded = |d: &&&DistanceReport| d.sd.is_some_and(|sd| step > ROUNDED * sd);
    let rounded = many.iter().filter(is_rounded).count();
    if rounded > 0 {
        let alone = many.iter().filter(|d| d.different == 1).count();
        warnings.push(Code::QuantisedReadings.warning(format!(
            "readings are rounded to steps of {} {unit}, more than half of their standard deviation at {rounded} of {} distances; at {alone} all readings are the same: the fitted standard deviation there is at least that of rounding",
            number(step),
            many.len()
        )));
    }
    let several: Vec<&DistanceReport> = distances.iter().filter(|d| !d.peaks.is_empty()).collect();
    if let Some(most) = several
        .iter()
        .max_by(|a, b| least_share(a).total_cmp(&least_share(b)))
    {
        let peaks: Vec<String> = most
            .peaks
            .iter()
            .map(|p| format!("{} ({:.0} %)", number(p.centre), 100.0 * p.share))
            .collect();
        warnings.push(Code::SeveralPeaks.warning(format!(
            "readings have several peaks at {} of {} distances, e.g. at {}: {} {unit}; the model describes all of them by one normal distribution",
            several.len(),
            distances.len(),
            most.distance,
            peaks.join(", ")
        )));
    }
    warnings
}

/// Smallest number of readings at a distance for the warning about rounding.
const FEW: usize = 5;
/// Readings count as rounded if their steps are larger than this share of their standard deviation.
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
