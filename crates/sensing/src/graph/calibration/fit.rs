//! Fits a sensorgraph to a log of scans.

use std::fmt;

use rayon::prelude::*;
use serde::Serialize;

use super::evaluation::better_lookup;
use super::option::GraphOptions;
use super::polynomial::{FOLDS, SAMPLES_PER_TERM, fold, polynomial};
use super::regression::{Stop, monomials};
use super::sample::{frame_of_log, logged, samples};
use super::scan::ScanLog;
use crate::graph::model::{Frame, Polynomial, Sensorgraph};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{mean, median};
use realgap_core::warning::{Code, Warning};

/// The error of a sensorgraph if the poses are shifted in time against the scans.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Lag {
    /// Time from a pose to its scan, seconds.
    pub lag_s: f64,
    /// Mean absolute error of the cross-validation over parts of the path, metres.
    pub error_m: f64,
}

/// A fitted sensorgraph and the errors by which it was chosen.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedGraph {
    /// The model.
    #[serde(skip)]
    pub model: Sensorgraph,
    /// Number of scans of the log.
    pub scans: usize,
    /// Mean absolute error of the cross-validation over parts of the path, metres, with polynomials for headings and segments; `None`
    /// if it was not tried.
    pub robot_frame_error_m: Option<f64>,
    /// Mean absolute error of the cross-validation with polynomials for directions of the world, metres.
    pub world_frame_error_m: Option<f64>,
    /// Mean absolute error of the cross-validation with the scan at the nearest logged pose, metres.
    pub nearest_error_m: Option<f64>,
    /// Mean absolute error of the cross-validation with the scan at the nearest logged position, turned to the heading, metres.
    pub turned_error_m: Option<f64>,
    /// Errors of the chosen model with poses half an interval before and after their scans.
    pub lags: Vec<Lag>,
    /// The chosen frame.
    pub frame: Frame,
    /// Number of polynomials.
    pub polynomials: usize,
    /// Number of terms of all polynomials.
    pub terms: usize,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// Fits a sensorgraph to a log.
///
/// # Errors
/// Options out of range, a log that is too short or without a range, a robot that never moved.
pub fn fit(log: &ScanLog, options: &GraphOptions) -> Result<FittedGraph> {
    options.check()?;
    if log.scans.len() < 2 * FOLDS {
        return Err(Error::invalid("too few scans for a sensorgraph")
            .found(log.scans.len())
            .allowed(format!("{} or more", 2 * FOLDS)));
    }
    let base = frame_of_log(log, options)?;
    let mut warnings = Vec::new();
    let frames = match options.frame {
        Some(frame) => vec![frame],
        None => vec![Frame::Robot, Frame::World],
    };
    let mut tried: Vec<(Frame, f64, Sensorgraph)> = Vec::new();
    for frame in frames {
        let graph = Sensorgraph {
            frame,
            ..base.clone()
        };
        let error_m = if options.frame.is_some() {
            0.0
        } else {
            left_out_error_m(log, &graph, options)
        };
        tried.push((frame, error_m, graph));
    }
    let is_open = options.frame.is_none();
    let lookup = |frame: Frame| {
        let graph = Sensorgraph {
            frame,
            ..base.clone()
        };
        is_open.then(|| left_out_error_m(log, &graph, options))
    };
    let (nearest_error_m, turned_error_m) = (lookup(Frame::Nearest), lookup(Frame::Turned));
    let error_of = |wanted: Frame| {
        tried
            .iter()
            .find(|(frame, ..)| *frame == wanted && options.frame.is_none())
            .map(|t| t.1)
    };
    let (robot_frame_error_m, world_frame_error_m) =
        (error_of(Frame::Robot), error_of(Frame::World));
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (frame, error_m, graph) = tried.remove(0);
    let mut lags = Vec::new();
    if is_open {
        let looked_up = [
            (Frame::Nearest, nearest_error_m),
            (Frame::Turned, turned_error_m),
        ];
        warnings.extend(better_lookup(error_m, &looked_up));
        lags = with_lags(log, &graph, options, error_m);
    }
    let whole: Vec<bool> = vec![true; log.scans.len()];
    let mut model = with_polynomials(log, graph, options, &whole);
    let empty = model.polynomials.iter().filter(|p| p.samples == 0).count();
    if empty > 0 {
        warnings.push(Code::EmptyHeadings.warning(format!(
            "the log has no sample for {empty} of {} polynomials; a mean of the log is used in their place",
            model.polynomials.len()
        )));
    }
    if let Stop::Terms(asked) = options.stop {
        let asked = asked.min(monomials(options.degree).len());
        let short = |p: &&Polynomial| p.samples > 0 && p.terms.len() < asked;
        let fewer = model.polynomials.iter().filter(short).count();
        if fewer > 0 {
            warnings.push(Code::FewerTerms.warning(format!(
                "{fewer} of {} polynomials have fewer than {asked} terms: each term needs {SAMPLES_PER_TERM} samples at different positions",
                model.polynomials.len()
            )));
        }
    }
    model.log = logged(log, &model);
    Ok(FittedGraph {
        scans: log.scans.len(),
        robot_frame_error_m,
        world_frame_error_m,
        nearest_error_m,
        turned_error_m,
        lags,
        frame,
        polynomials: model.polynomials.len(),
        terms: model.polynomials.iter().map(|p| p.terms.len()).sum(),
        warnings,
        model,
    })
}

fn with_polynomials(
    log: &ScanLog,
    graph: Sensorgraph,
    options: &GraphOptions,
    used: &[bool],
) -> Sensorgraph {
    let samples = samples(log, &graph, used);
    let everything = mean(&graph.means_m);
    let polynomials = samples
        .par_iter()
        .enumerate()
        .map(|(index, samples)| {
            let instead = match graph.frame {
                Frame::Robot => graph.means_m[index % graph.segments_deg.len()],
                _ => everything,
            };
            polynomial(samples, options, instead)
        })
        .collect();
    Sensorgraph {
        polynomials,
        ..graph
    }
}

/// A lag is reported as better if its error is below this share of the error without a lag.
const MATTERS: f64 = 0.98;

/// The errors with poses of half an interval between scans before and after each scan, and without a lag.
fn with_lags(log: &ScanLog, graph: &Sensorgraph, options: &GraphOptions, error_m: f64) -> Vec<Lag> {
    let steps_s: Vec<f64> = log
        .scans
        .windows(2)
        .map(|w| w[1].time_s - w[0].time_s)
        .filter(|dt| *dt > 0.0)
        .collect();
    if steps_s.is_empty() {
        return Vec::new();
    }
    let half_s = 0.5 * median(&steps_s);
    [-half_s, 0.0, half_s]
        .into_iter()
        .map(|lag_s| Lag {
            lag_s,
            error_m: if lag_s == 0.0 {
                error_m
            } else {
                left_out_error_m(&log.with_lag(lag_s), graph, options)
            },
        })
        .collect()
}

/// Mean absolute error of segments in a cross-validation over parts of the path, metres.
fn left_out_error_m(log: &ScanLog, graph: &Sensorgraph, options: &GraphOptions) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    let width = graph.width_deg.to_radians();
    for left_out in 0..FOLDS {
        let is_out = |index: usize| fold(index as f64 / log.scans.len() as f64) == left_out;
        let used: Vec<bool> = (0..log.scans.len()).map(|index| !is_out(index)).collect();
        let mut fitted = with_polynomials(log, graph.clone(), options, &used);
        if fitted.frame.is_lookup() {
            fitted.log = logged(&log.kept(&used), graph);
        }
        for (_, scan) in log
            .scans
            .iter()
            .enumerate()
            .filter(|(index, _)| is_out(*index))
        {
            for (segment, degrees) in graph.segments_deg.iter().enumerate() {
                if let Some(range_m) = log.median_m(scan, degrees.to_radians(), width) {
                    sum += (fitted.range_m(scan.position_world_m, scan.heading_rad, segment)
                        - range_m)
                        .abs();
                    count += 1;
                }
            }
        }
    }
    if count == 0 {
        f64::INFINITY
    } else {
        sum / f64::from(count)
    }
}

impl fmt::Display for FittedGraph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} scans, {} polynomials with {} terms",
            self.scans, self.polynomials, self.terms
        )?;
        if let (Some(robot), Some(world)) = (self.robot_frame_error_m, self.world_frame_error_m) {
            writeln!(
                f,
                "mean absolute error at left-out parts of the path: {robot:.3} m with a polynomial for every heading and segment, {world:.3} m with a polynomial for every direction of the world"
            )?;
        }
        if let (Some(nearest), Some(turned)) = (self.nearest_error_m, self.turned_error_m) {
            writeln!(
                f,
                "error without polynomials: {nearest:.3} m with the scan at the nearest logged pose, {turned:.3} m with the scan at the nearest logged place, turned to the heading"
            )?;
        }
        let at = |lag: &Lag| format!("{:.3} m at {:+.2} s", lag.error_m, lag.lag_s);
        if let [before, none, after] = self.lags.as_slice() {
            let least = before.error_m.min(after.error_m);
            let words = if least < MATTERS * none.error_m {
                "a lag predicts better: fit and evaluate with that lag"
            } else {
                "a lag is not needed"
            };
            writeln!(
                f,
                "error by the time from a pose to its scan: {}, {}, {}: {words}",
                at(before),
                at(none),
                at(after)
            )?;
        }
        let chosen = match self.frame {
            Frame::Nearest => "the scan at the nearest logged pose",
            Frame::Turned => "the scan at the nearest logged place, turned to the heading",
            Frame::Robot => "one polynomial for every heading and segment",
            Frame::World => "one polynomial for every direction of the world",
        };
        write!(f, "chosen: {chosen}")
    }
}
