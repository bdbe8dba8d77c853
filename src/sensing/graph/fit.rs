//! From a log of scans to a sensorgraph.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

use super::model::{Frame, LoggedPose, NOTHING, Polynomial, Sensorgraph, Term};
use super::regression::{Powers, Stop, count, estimate, monomial, monomials, order};
use super::scan::ScanLog;
use crate::error::{Error, Result};
use crate::statistics::mean;
use crate::warning::{Code, Warning};

/// How a log becomes a sensorgraph.
#[derive(Debug, Clone, PartialEq)]
pub struct GraphOptions {
    /// Largest degree of the polynomials.
    pub degree: u32,
    /// Ranges of headings, or directions of the world.
    pub headings: usize,
    /// Width of a segment of the scan, degrees.
    pub width_deg: f64,
    /// When no more terms are taken.
    pub stop: Stop,
    /// What the polynomials are of; where there is none, what foretells parts of the way that are left out better.
    pub frame: Option<Frame>,
}

impl Default for GraphOptions {
    fn default() -> Self {
        Self {
            degree: 4,
            headings: 12,
            width_deg: 30.0,
            stop: Stop::Validation,
            frame: None,
        }
    }
}

/// A fitted sensorgraph and what chose it.
#[derive(Debug, Clone, Serialize)]
pub struct FittedGraph {
    /// The model.
    #[serde(skip)]
    pub model: Sensorgraph,
    /// Scans of the log.
    pub scans: usize,
    /// Mean absolute error over parts of the way that were left out, metres, with polynomials of headings and segments; `None` where it
    /// was not tried.
    pub robot_frame_error_m: Option<f64>,
    /// And with polynomials of directions of the world.
    pub world_frame_error_m: Option<f64>,
    /// Which was taken.
    pub frame: Frame,
    /// Number of polynomials,
    pub polynomials: usize,
    /// and of all their terms.
    pub terms: usize,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Parts of the way that are left out in turn: neighbouring samples see nearly the same.
const FOLDS: usize = 5;
/// Most terms of a polynomial.
const MOST_TERMS: usize = 15;
/// A polynomial has at most one term for so many samples.
const SAMPLES_PER_TERM: usize = 3;
/// Most poses that are kept for the baselines.
const MOST_POSES: usize = 2000;

/// A sample of one polynomial: scaled place, range, and where on the way (0 to 1) it was taken.
#[derive(Debug, Clone, Copy)]
struct Sample {
    place: [f64; 2],
    range_m: f64,
    way: f64,
}

/// Fits a sensorgraph to a log.
///
/// # Errors
/// Options out of range, a log too short or without a return, a robot that never moved.
pub fn fit(log: &ScanLog, options: &GraphOptions) -> Result<FittedGraph> {
    check(options)?;
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
    let error_of = |wanted: Frame| {
        tried
            .iter()
            .find(|(frame, ..)| *frame == wanted && options.frame.is_none())
            .map(|t| t.1)
    };
    let (robot_frame_error_m, world_frame_error_m) =
        (error_of(Frame::Robot), error_of(Frame::World));
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (frame, _, graph) = tried.remove(0);
    let whole: Vec<bool> = vec![true; log.scans.len()];
    let mut model = with_polynomials(log, graph, options, &whole);
    let empty = model.polynomials.iter().filter(|p| p.samples == 0).count();
    if empty > 0 {
        warnings.push(Warning::new(
            Code::EmptyHeadings,
            format!("the log has no sample for {empty} of {} polynomials; the mean of all stands in for them", model.polynomials.len()),
        ));
    }
    model.log = logged(log, &model);
    Ok(FittedGraph {
        scans: log.scans.len(),
        robot_frame_error_m,
        world_frame_error_m,
        frame,
        polynomials: model.polynomials.len(),
        terms: model.polynomials.iter().map(|p| p.terms.len()).sum(),
        warnings,
        model,
    })
}

fn check(options: &GraphOptions) -> Result<()> {
    let range = |field: &str, found: f64, low: f64, high: f64| {
        if (low..=high).contains(&found) {
            return Ok(());
        }
        Err(Error::invalid("out of range")
            .field(field)
            .found(found)
            .allowed(format!("{low} to {high}")))
    };
    range("degree", f64::from(options.degree), 0.0, 8.0)?;
    range("headings", options.headings as f64, 1.0, 360.0)?;
    range("width", options.width_deg, 1.0, 180.0)?;
    match options.stop {
        Stop::Err(share) => range("error reduction ratio", share, 0.0, 1.0),
        Stop::Terms(terms) => range("terms", terms as f64, 1.0, 100.0),
        _ => Ok(()),
    }
}

/// Segments, scale and means of a log; no polynomials yet.
fn frame_of_log(log: &ScanLog, options: &GraphOptions) -> Result<Sensorgraph> {
    let of = |axis: usize| {
        log.scans
            .iter()
            .map(move |scan| scan.position_world_m[axis])
    };
    let ends = |axis: usize| {
        (
            of(axis).fold(f64::INFINITY, f64::min),
            of(axis).fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let ((x0, x1), (y0, y1)) = (ends(0), ends(1));
    let scale_m = 0.5 * (x1 - x0).max(y1 - y0);
    if scale_m < 1e-3 {
        return Err(Error::invalid(
            "the robot never moved: a sensorgraph needs different places",
        ));
    }
    let segments_deg = segments(log, options.width_deg);
    let width = options.width_deg.to_radians();
    let mut means_m = Vec::new();
    for degrees in &segments_deg {
        let ranges: Vec<f64> = log
            .scans
            .iter()
            .filter_map(|scan| log.median_m(scan, degrees.to_radians(), width))
            .collect();
        means_m.push(if ranges.is_empty() {
            f64::NAN
        } else {
            mean(&ranges)
        });
    }
    let known: Vec<f64> = means_m.iter().copied().filter(|m| m.is_finite()).collect();
    if known.is_empty() {
        return Err(Error::invalid("not a single beam came back"));
    }
    let middle = mean(&known);
    means_m
        .iter_mut()
        .filter(|m| m.is_nan())
        .for_each(|m| *m = middle);
    Ok(Sensorgraph {
        frame: Frame::Robot,
        segments_deg,
        width_deg: options.width_deg,
        headings: options.headings,
        centre_m: (0.5 * (x0 + x1), 0.5 * (y0 + y1)),
        scale_m,
        means_m,
        polynomials: Vec::new(),
        log: Vec::new(),
    })
}

/// Middles of the segments: all round from straight ahead, or from the rightmost beam to the leftmost.
fn segments(log: &ScanLog, width_deg: f64) -> Vec<f64> {
    if log.is_all_round() {
        let count = (360.0 / width_deg).round().max(1.0) as usize;
        return (0..count).map(|k| (k as f64 + 0.5) * width_deg).collect();
    }
    let least = log
        .beams_rad
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min)
        .to_degrees();
    let most = log
        .beams_rad
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max)
        .to_degrees();
    let count = ((most - least) / width_deg).round().max(1.0) as usize;
    (0..count)
        .map(|k| least + (k as f64 + 0.5) * width_deg)
        .collect()
}

/// The samples of every polynomial from the scans that are `used`.
fn samples(log: &ScanLog, graph: &Sensorgraph, used: &[bool]) -> Vec<Vec<Sample>> {
    let segments = graph.segments_deg.len();
    let count = match graph.frame {
        Frame::Robot => graph.headings * segments,
        Frame::World => graph.headings,
    };
    let width = graph.width_deg.to_radians();
    let step = std::f64::consts::TAU / graph.headings as f64;
    let mut all = vec![Vec::new(); count];
    for (index, scan) in log
        .scans
        .iter()
        .enumerate()
        .filter(|(index, _)| used[*index])
    {
        let place = graph.scaled(scan.position_world_m);
        let way = index as f64 / log.scans.len() as f64;
        let mut push = |polynomial: usize, centre: f64| {
            if let Some(range_m) = log.median_m(scan, centre, width) {
                all[polynomial].push(Sample {
                    place,
                    range_m,
                    way,
                });
            }
        };
        match graph.frame {
            Frame::Robot => {
                let heading = graph.heading_bin(scan.heading_rad);
                for (segment, degrees) in graph.segments_deg.iter().enumerate() {
                    push(heading * segments + segment, degrees.to_radians());
                }
            }
            Frame::World => {
                for direction in 0..graph.headings {
                    let centre = direction as f64 * step - scan.heading_rad;
                    if is_seen(log, centre, width) {
                        push(direction, centre);
                    }
                }
            }
        }
    }
    all
}

/// Whether a whole segment lies within the beams.
fn is_seen(log: &ScanLog, centre_rad: f64, width_rad: f64) -> bool {
    if log.is_all_round() {
        return true;
    }
    let least = log.beams_rad.iter().copied().fold(f64::INFINITY, f64::min);
    let most = log
        .beams_rad
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let centre = super::scan::wrapped(centre_rad);
    centre - 0.5 * width_rad >= least - 0.02 && centre + 0.5 * width_rad <= most + 0.02
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
                Frame::World => everything,
            };
            polynomial(samples, options, instead)
        })
        .collect();
    Sensorgraph {
        polynomials,
        ..graph
    }
}

/// Regressors and ranges.
fn table(samples: &[Sample], terms: &[Powers]) -> (DMatrix<f64>, DVector<f64>) {
    (
        DMatrix::from_fn(samples.len(), terms.len(), |row, term| {
            monomial(terms[term], samples[row].place)
        }),
        DVector::from_iterator(samples.len(), samples.iter().map(|s| s.range_m)),
    )
}

fn limits(samples: &[Sample]) -> (f64, f64) {
    let of =
        |fold: fn(f64, f64) -> f64, from: f64| samples.iter().map(|s| s.range_m).fold(from, fold);
    (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
}

fn polynomial(samples: &[Sample], options: &GraphOptions, instead_m: f64) -> Polynomial {
    let constant = |value: f64| Term {
        powers: [0, 0],
        value,
        error: 0.0,
        ratio: 0.0,
    };
    if samples.is_empty() {
        return Polynomial {
            samples: 0,
            limits_m: (instead_m, instead_m),
            terms: vec![constant(instead_m)],
        };
    }
    let ranges: Vec<f64> = samples.iter().map(|s| s.range_m).collect();
    let (degree, terms) = match options.stop {
        Stop::Validation => validated(samples, options.degree),
        _ => (options.degree, MOST_TERMS),
    };
    fitted(samples, degree, terms, options.stop).unwrap_or_else(|| Polynomial {
        samples: samples.len(),
        limits_m: limits(samples),
        terms: vec![constant(mean(&ranges))],
    })
}

/// The polynomial of this degree with at most so many terms; `None` where none can be fitted.
fn fitted(samples: &[Sample], degree: u32, most: usize, stop: Stop) -> Option<Polynomial> {
    let powers = monomials(degree);
    let (regressors, ranges) = table(samples, &powers);
    let most = most.min((samples.len() / SAMPLES_PER_TERM).max(1));
    let mut chosen = order(&regressors, &ranges, most).ok()?;
    if stop != Stop::Validation {
        chosen.truncate(count(stop, &chosen, &ranges));
    }
    let found = estimate(&regressors, &ranges, &chosen).ok()?;
    let terms = chosen.iter().zip(found.values.iter().zip(&found.errors));
    Some(Polynomial {
        samples: samples.len(),
        limits_m: limits(samples),
        terms: terms
            .map(|(term, (value, error))| Term {
                powers: powers[term.index],
                value: *value,
                error: if error.is_finite() { *error } else { 0.0 },
                ratio: term.ratio,
            })
            .collect(),
    })
}

/// Which part of the way a sample is left out with.
fn fold(way: f64) -> usize {
    ((way * FOLDS as f64) as usize).min(FOLDS - 1)
}

/// Degree and number of terms that foretell parts of the way best: least mean absolute error, the smaller of equals.
fn validated(samples: &[Sample], most_degree: u32) -> (u32, usize) {
    let mut best = (f64::INFINITY, 0, 1);
    for degree in 0..=most_degree {
        let terms = monomials(degree);
        let mut sums = vec![0.0; terms.len().min(MOST_TERMS)];
        for left_out in 0..FOLDS {
            let (out, kept): (Vec<Sample>, Vec<Sample>) = samples
                .iter()
                .copied()
                .partition(|s| fold(s.way) == left_out);
            if out.is_empty() || kept.is_empty() {
                continue;
            }
            for (index, error) in errors_by_terms(&kept, &out, &terms, sums.len())
                .into_iter()
                .enumerate()
            {
                sums[index] += error;
            }
        }
        for (index, sum) in sums.iter().enumerate() {
            if *sum < best.0 * (1.0 - 1e-9) {
                best = (*sum, degree, index + 1);
            }
        }
    }
    (best.1, best.2)
}

/// Sum of absolute errors on `out` with the first 1, 2, … terms that `kept` chooses.
fn errors_by_terms(kept: &[Sample], out: &[Sample], terms: &[Powers], most: usize) -> Vec<f64> {
    let (regressors, ranges) = table(kept, terms);
    let allowed = most.min((kept.len() / SAMPLES_PER_TERM).max(1));
    let Ok(chosen) = order(&regressors, &ranges, allowed) else {
        return vec![f64::INFINITY; most];
    };
    let (least, largest) = limits(kept);
    (1..=most)
        .map(|count| {
            let first = &chosen[..count.min(chosen.len())];
            let Ok(found) = estimate(&regressors, &ranges, first) else {
                return f64::INFINITY;
            };
            out.iter()
                .map(|sample| {
                    let sum: f64 = first
                        .iter()
                        .zip(&found.values)
                        .map(|(term, value)| value * monomial(terms[term.index], sample.place))
                        .sum();
                    (sum.clamp(least, largest) - sample.range_m).abs()
                })
                .sum()
        })
        .collect()
}

/// Mean absolute error of segments over parts of the way that are left out, metres.
fn left_out_error_m(log: &ScanLog, graph: &Sensorgraph, options: &GraphOptions) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    let width = graph.width_deg.to_radians();
    for left_out in 0..FOLDS {
        let is_out = |index: usize| fold(index as f64 / log.scans.len() as f64) == left_out;
        let used: Vec<bool> = (0..log.scans.len()).map(|index| !is_out(index)).collect();
        let fitted = with_polynomials(log, graph.clone(), options, &used);
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

/// The log's poses and medians, thinned evenly where there are many.
fn logged(log: &ScanLog, graph: &Sensorgraph) -> Vec<LoggedPose> {
    let width = graph.width_deg.to_radians();
    let every = log.scans.len().div_ceil(MOST_POSES);
    let millimetres = |v: f64| (v * 1e3).round() / 1e3;
    let step = std::f64::consts::TAU / graph.headings as f64;
    log.scans
        .iter()
        .step_by(every)
        .map(|scan| {
            let median = |centre: f64| {
                log.median_m(scan, centre, width)
                    .map_or(NOTHING, millimetres)
            };
            LoggedPose {
                pose: (
                    millimetres(scan.position_world_m[0]),
                    millimetres(scan.position_world_m[1]),
                    (scan.heading_rad * 1e4).round() / 1e4,
                ),
                segments_m: graph
                    .segments_deg
                    .iter()
                    .map(|degrees| median(degrees.to_radians()))
                    .collect(),
                directions_m: (0..graph.headings)
                    .map(|k| k as f64 * step - scan.heading_rad)
                    .map(|centre| {
                        if is_seen(log, centre, width) {
                            median(centre)
                        } else {
                            NOTHING
                        }
                    })
                    .collect(),
            }
        })
        .collect()
}
