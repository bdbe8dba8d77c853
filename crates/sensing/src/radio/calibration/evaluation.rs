//! Evaluates a radio model on a log that was not used for its fit, and compares it with baselines.

use std::fmt;

use serde::Serialize;

use super::fingerprint::Fingerprints;
use super::fit::root_mean_square;
use super::log::RadioLog;
use super::place::places;
use crate::arena::{Anchor, Arena};
use crate::radio::link::Link;
use crate::radio::model::RadioModel;
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{mean, percentile_interval, resamples};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// The errors of the model for one anchor of the log.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AnchorReport {
    /// Name of the anchor.
    pub anchor: String,
    /// Number of strengths.
    pub readings: usize,
    /// Root mean square error, dB.
    pub rmse_db: f64,
    /// Mean of measured minus predicted, dB.
    pub bias_db: f64,
    /// Share of strengths in the 90 % interval.
    pub coverage_90: f64,
}

/// The error of a baseline: a simpler prediction of the strength, with which the model is compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RadioBaseline {
    /// Name of the baseline.
    pub name: String,
    /// Root mean square error, dB.
    pub rmse_db: f64,
}

/// The errors of a radio model on a log.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluation {
    /// Name of the propagation model.
    pub propagation: String,
    /// Root mean square error, dB.
    pub rmse_db: f64,
    /// Lower end of the 90 % interval of the root mean square error, over resampled places, dB.
    pub rmse_low_db: f64,
    /// Upper end of the 90 % interval of the root mean square error, over resampled places, dB.
    pub rmse_high_db: f64,
    /// Mean of measured minus predicted, dB.
    pub bias_db: f64,
    /// Share of strengths in the model's 90 % interval.
    pub coverage_90: f64,
    /// Half width of the model's 90 % interval, dB.
    pub interval_90_db: f64,
    /// The errors for each anchor.
    pub anchors: Vec<AnchorReport>,
    /// The errors of baselines on the same log: other models of the same fit, the mean strength of that fit, and fingerprints if they
    /// were given.
    #[serde(rename = "guesses")]
    pub baselines: Vec<RadioBaseline>,
    /// Number of strengths of the log.
    pub readings: usize,
    /// Number of missing strengths.
    pub missing: usize,
    /// A map of the errors: the middle of each square of a quarter of a metre, metres, and the root mean square error in it, dB.
    #[serde(skip)]
    pub errors: Vec<([f64; 2], f64)>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

const RESAMPLES: usize = 1000;

impl Evaluation {
    /// Evaluates the model on a log; `fingerprints` (another log used as a map) are a further baseline.
    ///
    /// # Errors
    /// A log without strengths, an anchor of the log whose position is unknown.
    pub fn new(
        model: &RadioModel,
        arena: &Arena,
        anchors: &[Anchor],
        log: &RadioLog,
        fingerprints: Option<&Fingerprints>,
    ) -> Result<Self> {
        if log.readings.is_empty() {
            return Err(Error::invalid("no signal was received in the whole log"));
        }
        let anchors = log.placed(anchors)?;
        let links: Vec<Link> = log
            .readings
            .iter()
            .map(|reading| {
                let robot_m = model.robot_at(reading.position_m);
                Link::new(arena, robot_m, anchors[reading.anchor].position_m)
            })
            .collect();
        let errors_of = |model: &RadioModel| -> Vec<f64> {
            links
                .iter()
                .zip(&log.readings)
                .map(|(link, reading)| reading.strength_dbm - model.strength_dbm(link))
                .collect()
        };
        let errors = errors_of(model);
        let half = model.interval_90_db;
        let within = |errors: &[f64]| {
            errors.iter().filter(|e| e.abs() <= half).count() as f64 / errors.len() as f64
        };
        let per_anchor = anchors.iter().enumerate().filter_map(|(index, anchor)| {
            let own: Vec<f64> = log
                .readings
                .iter()
                .zip(&errors)
                .filter(|(reading, _)| reading.anchor == index)
                .map(|(_, error)| *error)
                .collect();
            (!own.is_empty()).then(|| AnchorReport {
                anchor: anchor.name.clone(),
                readings: own.len(),
                rmse_db: root_mean_square(&own),
                bias_db: mean(&own),
                coverage_90: within(&own),
            })
        });
        let (rmse_low_db, rmse_high_db) = interval(log, &errors);
        let mut warnings = log.warnings.clone();
        if half == 0.0 {
            warnings.push(Code::NoInterval.warning(
                "the model states no interval, so its coverage cannot be evaluated; the field `interval_90_db` of its file states the interval, and a fit writes it",
            ));
        }
        Ok(Self {
            propagation: model.propagation.name().to_owned(),
            rmse_db: root_mean_square(&errors),
            rmse_low_db,
            rmse_high_db,
            bias_db: mean(&errors),
            coverage_90: within(&errors),
            interval_90_db: half,
            anchors: per_anchor.collect(),
            baselines: baselines(model, log, fingerprints, errors_of),
            readings: log.readings.len(),
            missing: log.missing,
            errors: map(log, &errors),
            warnings,
        })
    }
}

fn baselines(
    model: &RadioModel,
    log: &RadioLog,
    fingerprints: Option<&Fingerprints>,
    errors_of: impl Fn(&RadioModel) -> Vec<f64>,
) -> Vec<RadioBaseline> {
    let baseline = |name: String, errors: &[f64]| RadioBaseline {
        name,
        rmse_db: root_mean_square(errors),
    };
    let mut baselines: Vec<RadioBaseline> = model
        .others
        .iter()
        .map(|other| {
            let errors = errors_of(&model.with(other));
            baseline(other.propagation.name().to_owned(), &errors)
        })
        .collect();
    let off =
        |predicted_dbm: f64, reading: &super::PlaceReading| reading.strength_dbm - predicted_dbm;
    let constant: Vec<f64> = log
        .readings
        .iter()
        .map(|r| off(model.mean_dbm, r))
        .collect();
    baselines.push(baseline("mean strength of the fit".to_owned(), &constant));
    if let Some(prints) = fingerprints {
        let own: Vec<f64> = log
            .readings
            .iter()
            .filter_map(|r| {
                let predicted_dbm = prints.strength_dbm(&log.anchors[r.anchor], r.position_m)?;
                Some(off(predicted_dbm, r))
            })
            .collect();
        if !own.is_empty() {
            baselines.push(baseline("fingerprints".to_owned(), &own));
        }
    }
    baselines
}

/// The 90 % interval of the root mean square error, over resampled places.
fn interval(log: &RadioLog, errors: &[f64]) -> (f64, f64) {
    let (place, count) = places(log);
    let (mut squares, mut counts) = (vec![0.0; count], vec![0.0; count]);
    for (place, error) in place.iter().zip(errors) {
        squares[*place] += error * error;
        counts[*place] += 1.0;
    }
    let values: Vec<f64> = resamples(count, RESAMPLES, 1)
        .iter()
        .map(|resample| (resample.mean(&squares) / resample.mean(&counts)).sqrt())
        .collect();
    percentile_interval(&values, 0.05).unwrap_or((f64::NAN, f64::NAN))
}

/// Side of a cell of the map, metres.
pub const CELL_M: f64 = 0.25;

fn map(log: &RadioLog, errors: &[f64]) -> Vec<([f64; 2], f64)> {
    let mut cells: std::collections::BTreeMap<[i64; 2], Vec<f64>> =
        std::collections::BTreeMap::new();
    for (reading, error) in log.readings.iter().zip(errors) {
        let cell = reading.position_m.map(|v| (v / CELL_M).floor() as i64);
        cells.entry(cell).or_default().push(*error);
    }
    cells
        .into_iter()
        .map(|(cell, own)| {
            (
                cell.map(|k| (k as f64 + 0.5) * CELL_M),
                root_mean_square(&own),
            )
        })
        .collect()
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: error {:.2} dB ({:.2} to {:.2}), mean residual {:+.2} dB; {:.1} % of {} within {:.1} dB\n",
            self.propagation,
            self.rmse_db,
            self.rmse_low_db,
            self.rmse_high_db,
            self.bias_db,
            100.0 * self.coverage_90,
            counted(self.readings, "strength"),
            self.interval_90_db
        )?;
        let table = TextTable::of(
            &self.anchors,
            &[
                ("anchor", Left, &|a| a.anchor.clone()),
                ("strengths", Right, &|a| a.readings.to_string()),
                ("error", Right, &|a| format!("{:.2} dB", a.rmse_db)),
                ("mean residual", Right, &|a| format!("{:+.2} dB", a.bias_db)),
                ("in the 90 % interval", Right, &|a| {
                    format!("{:.1} %", 100.0 * a.coverage_90)
                }),
            ],
        );
        writeln!(f, "{}", table.render(false))?;
        let others = TextTable::of(
            &self.baselines,
            &[
                ("baseline", Left, &|g| g.name.clone()),
                ("error", Right, &|g| format!("{:.2} dB", g.rmse_db)),
            ],
        );
        f.write_str(others.render(false).trim_end())
    }
}
