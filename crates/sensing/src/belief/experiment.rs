//! Runs the Bayes filter on many trials of a few readings at a distance, for a simulated sensor and for a real log (paper 000,
//! section 5.1).

use std::fmt;

use rand::RngExt;
use serde::Serialize;

use super::Belief;
use crate::range::{Beam, RangeModel, RangeSensor, ReadingLog};
use realgap_core::error::{Error, Result};
use realgap_core::random::{Numbered, Once};
use realgap_core::range::Range;
use realgap_core::statistics::{mean, quantile};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::warning::{Code, Warning};

/// Options of the trials.
#[derive(Debug, Clone, PartialEq)]
pub struct BeliefOptions {
    /// True distances at the beginning of a trial, in the model's unit.
    pub distances: Vec<f64>,
    /// Number of trials at each distance.
    pub trials: usize,
    /// Number of readings of a trial.
    pub readings: usize,
    /// Number of cells of the grid over the sensor's range.
    pub cells: usize,
    /// Distance by which the robot approaches from one reading to the next, in the model's unit; 0 for a robot that stands still.
    pub approach: f64,
    /// Standard deviation of the approach that the filter uses, in the model's unit.
    pub approach_sd: f64,
    /// Seed of the simulated readings.
    pub seed: u64,
}

impl Default for BeliefOptions {
    fn default() -> Self {
        Self {
            distances: Vec::new(),
            trials: 200,
            readings: 10,
            cells: 401,
            approach: 0.0,
            approach_sd: 0.0,
            seed: 1,
        }
    }
}

/// The beliefs after the readings of many trials.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrialSet {
    /// Number of trials.
    pub trials: usize,
    /// Probability of each cell, averaged over the trials.
    pub mean: Vec<f64>,
    /// 5 % quantile of the probability of each cell over the trials.
    pub q05: Vec<f64>,
    /// 95 % quantile of the probability of each cell over the trials; together with the 5 % quantile, a band of 90 %.
    pub q95: Vec<f64>,
    /// Standard deviation of a trial's belief, averaged over the trials, in the model's unit.
    pub belief_sd: f64,
    /// Mean of the beliefs minus the true distance, averaged over the trials, in the model's unit.
    pub bias: f64,
    /// Share of trials whose 90 % credible interval contains the true distance.
    pub held: f64,
    /// Number of times that a belief was set to the uniform distribution because a reading was impossible at every distance.
    pub restarts: usize,
}

/// Simulated and real beliefs at one distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DistanceBelief {
    /// True distance at the end of a trial, in the model's unit.
    pub distance: f64,
    /// Distances of the cells, in the model's unit.
    pub cells: Vec<f64>,
    /// The trials of the simulated sensor.
    pub simulated: TrialSet,
    /// The trials of the real log, if there is one.
    pub real: Option<TrialSet>,
    /// Number of readings of the log at this distance.
    pub logged: Option<usize>,
    /// Common area of the simulated and the real mean belief, 0 to 1.
    pub overlap: Option<f64>,
    /// Standard deviation of a Kalman filter after as many readings, in the model's unit; `None` unless the mean reading is linear in
    /// the distance and the robot stands still.
    pub kalman_sd: Option<f64>,
}

/// Beliefs at some distances.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BeliefReport {
    /// Symbol of the model's unit of length.
    pub unit: &'static str,
    /// Number of readings of a trial.
    pub readings: usize,
    /// The beliefs at each distance.
    pub distances: Vec<DistanceBelief>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// If the standard deviation of a belief is below this share of a cell, it is determined by the grid rather than by the sensor.
const NARROW: f64 = 0.6;
/// Level of credible intervals and bands.
const LEVEL: f64 = 0.9;

impl BeliefReport {
    /// Runs the filter on readings that the model draws, and on readings of a log if there is one.
    ///
    /// # Errors
    /// No distance, distances that are not positive, no trials or readings, a log in other units or without readings at a distance, a
    /// log together with a motion.
    pub fn new(
        model: &RangeModel,
        log: Option<&ReadingLog>,
        options: &BeliefOptions,
    ) -> Result<Self> {
        check(model, log, options)?;
        let metres = model.distance_unit.metres();
        let mut warnings = Vec::new();
        let mut distances = Vec::new();
        for (index, &start) in options.distances.iter().enumerate() {
            let distance = start - options.approach * (options.readings - 1) as f64;
            for d in [start, distance] {
                warnings.extend(model.warning_at(d * metres));
            }
            let simulated = simulate(model, options, index, start);
            let real_readings = log.map(|log| logged(log, distance));
            let real = match &real_readings {
                Some(readings) if readings.is_empty() => {
                    return Err(Error::invalid("the log has no readings at this distance")
                        .field("distances")
                        .found(format!("{distance} {}", model.distance_unit.symbol())));
                }
                Some(readings) => Some(replay(model, options, index, distance, readings)),
                None => None,
            };
            let overlap = real.as_ref().map(|real: &TrialSet| {
                real.mean
                    .iter()
                    .zip(&simulated.mean)
                    .map(|(a, b)| a.min(*b))
                    .sum()
            });
            distances.push(DistanceBelief {
                distance,
                cells: grid(model, options)
                    .distances_m()
                    .iter()
                    .map(|d| d / metres)
                    .collect(),
                simulated,
                real,
                logged: real_readings.map(|r| r.len()),
                overlap,
                kalman_sd: kalman_sd(model, distance, options),
            });
        }
        let restarts: usize = distances
            .iter()
            .map(|s| s.simulated.restarts + s.real.as_ref().map_or(0, |r| r.restarts))
            .sum();
        let cell = grid(model, options).cell_m() / metres;
        // For a robot that stands still, the grid is refined; for a moving robot, all beliefs are on one grid.
        let narrow = |side: &&DistanceBelief| {
            options.approach != 0.0 && side.simulated.belief_sd < NARROW * cell
        };
        if let Some(side) = distances.iter().find(narrow) {
            warnings.push(Code::CoarseGrid.warning(format!(
                "cells of {cell:.3} {} are too wide for beliefs at {}: use more cells",
                model.distance_unit.symbol(),
                side.distance
            )));
        }
        if restarts > 0 {
            warnings.push(Code::BeliefRestarted.warning(format!(
                "{restarts} readings were impossible at every distance; the belief was set to the uniform distribution after each of them"
            )));
        }
        Ok(Self {
            unit: model.distance_unit.symbol(),
            readings: options.readings,
            distances,
            warnings,
        })
    }
}

fn check(model: &RangeModel, log: Option<&ReadingLog>, options: &BeliefOptions) -> Result<()> {
    let counts = Range::within(1.0, 100.0, "");
    counts.check(options.distances.len() as f64, "distances")?;
    let way = options.approach * (options.readings.max(1) - 1) as f64;
    for distance in &options.distances {
        let range = Range::above(way.max(0.0), 1e9, model.distance_unit.symbol());
        range.check(*distance, "distances")?;
    }
    for (field, found, least, most) in [
        ("trials", options.trials, 1.0, 1e6),
        ("readings", options.readings, 1.0, 1e5),
        ("cells", options.cells, 2.0, 1e5),
    ] {
        Range::within(least, most, "").check(found as f64, field)?;
    }
    Range::within(-1e9, 1e9, "").check(options.approach, "approach")?;
    Range::within(0.0, 1e9, "").check(options.approach_sd, "approach_sd")?;
    let Some(log) = log else {
        return Ok(());
    };
    if options.approach != 0.0 {
        return Err(Error::invalid("a log at fixed distances has no approach")
            .field("approach")
            .hint("leave out the approach or the log"));
    }
    let own = (model.distance_unit.symbol(), model.reading_unit.symbol());
    let others = (log.distance_unit.symbol(), log.reading_unit.symbol());
    if own != others {
        return Err(Error::invalid("log and model have different units")
            .found(format!(
                "distances in {}, readings in `{}`",
                others.0, others.1
            ))
            .allowed(format!("distances in {}, readings in `{}`", own.0, own.1)));
    }
    Ok(())
}

/// A uniform belief over the sensor's range, extended to the distances of the trials if these lie outside of it.
fn grid(model: &RangeModel, options: &BeliefOptions) -> Belief {
    let metres = model.distance_unit.metres();
    let way = options.approach * (options.readings - 1) as f64;
    let places = options.distances.iter().flat_map(|d| [*d, d - way]);
    let (near_m, far_m) = places.fold(model.range_m(), |(near_m, far_m), d| {
        (near_m.min(d * metres), far_m.max(d * metres))
    });
    Belief::uniform(near_m, far_m, options.cells)
}

/// The belief after the readings of one trial.
struct Trial {
    /// The belief on the grid of all trials.
    whole: Belief,
    /// The belief on a grid that is fine enough for it.
    fine: Belief,
}

/// Smallest number of cells of a refined grid.
const FINE_CELLS: usize = 65;
/// A refined grid extends by this number of cells of the coarser grid on each side of the mean.
const SPAN: f64 = 2.0;
/// Largest number of refinements; each grid is at least sixteen times finer than the one before.
const MOST_GRIDS: usize = 10;

impl Trial {
    fn new(model: &RangeModel, options: &BeliefOptions, readings: &[Option<f64>]) -> Self {
        let metres = model.distance_unit.metres();
        let after_all = |mut belief: Belief| {
            for (index, value) in readings.iter().enumerate() {
                if index > 0 && options.approach != 0.0 {
                    belief.move_by(options.approach * metres, options.approach_sd * metres);
                }
                if let Some(value) = value {
                    belief.observe_within(model, *value);
                }
            }
            belief
        };
        let whole = after_all(grid(model, options));
        let (near_m, far_m) = whole.ends_m();
        let mut fine = whole.clone();
        for _ in 0..MOST_GRIDS {
            let cell_m = fine.cell_m();
            if options.approach != 0.0 || fine.sd_m() >= NARROW * cell_m {
                break;
            }
            let mean_m = fine.mean_m();
            fine = after_all(Belief::uniform(
                (mean_m - SPAN * cell_m).max(near_m),
                (mean_m + SPAN * cell_m).min(far_m),
                options.cells.max(FINE_CELLS),
            ));
        }
        Self { whole, fine }
    }
}

/// Trials of readings that the model draws.
fn simulate(model: &RangeModel, options: &BeliefOptions, index: usize, start: f64) -> TrialSet {
    let metres = model.distance_unit.metres();
    let trials: Vec<Trial> = (0..options.trials)
        .map(|trial| {
            let number = (index * options.trials + trial) as u64;
            let mut rng = Numbered::SensorReading.generator(options.seed, number);
            let readings: Vec<Option<f64>> = (0..options.readings)
                .map(|reading| start - options.approach * reading as f64)
                .map(|distance| model.draw(&Beam::straight(distance * metres), &mut rng))
                .collect();
            Trial::new(model, options, &readings)
        })
        .collect();
    let end = start - options.approach * (options.readings - 1) as f64;
    summary(&trials, end * metres, metres)
}

/// Readings of the log at a distance, in its order.
fn logged(log: &ReadingLog, distance: f64) -> Vec<Option<f64>> {
    let same = log
        .readings
        .iter()
        .filter(|r| (r.distance - distance).abs() < 1e-9 * distance.max(1.0));
    same.map(|r| r.value).collect()
}

/// Trials with readings of a log: the readings are used in order until all are used, then drawn at random with replacement.
fn replay(
    model: &RangeModel,
    options: &BeliefOptions,
    index: usize,
    distance: f64,
    readings: &[Option<f64>],
) -> TrialSet {
    let mut rng = Once::Subset.generator(options.seed.wrapping_add(index as u64));
    let mut next = 0;
    let trials: Vec<Trial> = (0..options.trials)
        .map(|_| {
            let mut of_trial = Vec::with_capacity(options.readings);
            for _ in 0..options.readings {
                of_trial.push(match readings.get(next) {
                    Some(value) => *value,
                    None => readings[rng.random_range(0..readings.len())],
                });
                next += 1;
            }
            Trial::new(model, options, &of_trial)
        })
        .collect();
    let metres = model.distance_unit.metres();
    summary(&trials, distance * metres, metres)
}

impl Belief {
    /// The probability below a distance; the probability of a cell is spread evenly over the cell.
    fn below(&self, distance_m: f64) -> f64 {
        let width = self.cell_m();
        let share = |middle: f64| ((distance_m - middle) / width + 0.5).clamp(0.0, 1.0);
        let cells = self.probabilities().into_iter().zip(&self.distances_m);
        cells.map(|(p, middle)| p * share(*middle)).sum()
    }
}

fn summary(trials: &[Trial], true_m: f64, metres: f64) -> TrialSet {
    let probabilities: Vec<Vec<f64>> = trials.iter().map(|t| t.whole.probabilities()).collect();
    let cells = probabilities.first().map_or(0, Vec::len);
    let of = |cell: usize| probabilities.iter().map(|p| p[cell]).collect::<Vec<f64>>();
    let tail = 0.5 * (1.0 - LEVEL);
    let held = trials
        .iter()
        .filter(|trial| (tail..=1.0 - tail).contains(&trial.fine.below(true_m)));
    let sds: Vec<f64> = trials.iter().map(|t| t.fine.sd_m() / metres).collect();
    let means: Vec<f64> = trials
        .iter()
        .map(|t| (t.fine.mean_m() - true_m) / metres)
        .collect();
    TrialSet {
        trials: trials.len(),
        mean: (0..cells).map(|cell| mean(&of(cell))).collect(),
        q05: (0..cells).map(|cell| quantile(&of(cell), tail)).collect(),
        q95: (0..cells)
            .map(|cell| quantile(&of(cell), 1.0 - tail))
            .collect(),
        belief_sd: mean(&sds),
        bias: mean(&means),
        held: held.count() as f64 / trials.len() as f64,
        restarts: trials.iter().map(|t| t.whole.restarts()).sum(),
    }
}

/// Standard deviation of a Kalman filter for a constant distance after the readings of a trial: gains K = P / (P + R) with R at the
/// true distance, and the variance of the uniform belief at the start.
fn kalman_sd(model: &RangeModel, distance: f64, options: &BeliefOptions) -> Option<f64> {
    if model.mean.form.name() != "linear" || options.approach != 0.0 {
        return None;
    }
    let slope = model.mean.values[1];
    let noise = (model.spread.at(distance) / slope).powi(2);
    let (near_m, far_m) = grid(model, options).ends_m();
    let mut variance = ((far_m - near_m) / model.distance_unit.metres()).powi(2) / 12.0;
    for _ in 0..options.readings {
        variance *= 1.0 - variance / (variance + noise);
    }
    Some(variance.sqrt())
}

impl fmt::Display for BeliefReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "beliefs after {} readings, in {}",
            self.readings, self.unit
        )?;
        let rows: Vec<(&DistanceBelief, &str, &TrialSet)> = self
            .distances
            .iter()
            .flat_map(|d| {
                let log = d.real.as_ref().map(|set| (d, "log", set));
                std::iter::once((d, "model", &d.simulated)).chain(log)
            })
            .collect();
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let only = |value: Option<f64>, is_wanted: bool, words: &dyn Fn(f64) -> String| {
            value.filter(|_| is_wanted).map_or(String::new(), words)
        };
        let table = TextTable::of(
            &rows,
            &[
                ("  distance", Right, &|(d, ..)| {
                    let digits = format!("{:.4}", d.distance);
                    digits
                        .trim_end_matches('0')
                        .trim_end_matches('.')
                        .to_owned()
                }),
                ("readings of", Left, &|(_, whose, _)| whose.to_string()),
                ("trials", Right, &|(.., set)| set.trials.to_string()),
                ("sd of the belief", Right, &|(.., set)| {
                    format!("{:.3}", set.belief_sd)
                }),
                ("mean - distance", Right, &|(.., set)| {
                    format!("{:+.3}", set.bias)
                }),
                ("distance in the 90 % interval", Right, &|(.., set)| {
                    percent(set.held)
                }),
                ("overlap", Right, &|(d, whose, _)| {
                    only(d.overlap, *whose == "log", &percent)
                }),
                ("sd of a Kalman filter", Right, &|(d, whose, _)| {
                    only(d.kalman_sd, *whose == "model", &|sd| format!("{sd:.3}"))
                }),
            ],
        );
        f.write_str(table.render(false).trim_end())
    }
}
