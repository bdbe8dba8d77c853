//! Evaluates a sensorgraph on a log that was not used for its fit (paper 001, sections 3.2.1 and 3.2.2).

use std::fmt;

use rand::RngExt;
use serde::Serialize;

use super::sample::ends;
use super::scan::ScanLog;
use crate::arena::Arena;
use crate::graph::model::{Frame, NOTHING, Sensorgraph};
use realgap_core::error::{Error, Result};
use realgap_core::random::Once;
use realgap_core::statistics::{
    autocorrelation_time, independent_pairs, mann_whitney, mean, spearman, spearman_effective,
    standard_deviation,
};
use realgap_core::table::Side::{Left, Right};
use realgap_core::table::TextTable;
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};

/// The errors of the model and of baselines in one segment of the scan.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SegmentReport {
    /// Middle of the segment, degrees counter-clockwise from straight ahead.
    pub segment_deg: f64,
    /// Number of scans in which a beam of the segment returned.
    pub samples: usize,
    /// Mean absolute error of the model, metres.
    pub mean_absolute_error_m: f64,
    /// Standard error of the mean absolute error, metres, corrected for the autocorrelation of errors along the path.
    pub standard_error_m: f64,
    /// Autocorrelation time of the errors: number of scans that contain as much information as one independent error.
    pub scans_per_error: f64,
    /// Mean absolute error of the segment's mean over the log of the fit, metres.
    pub baseline_constant_m: f64,
    /// Mean absolute error of the reading at the nearest logged pose, metres.
    pub baseline_nearest_m: Option<f64>,
    /// Mean absolute error of ideal beams in an arena, metres; `None` without an arena.
    pub baseline_ray_casting_m: Option<f64>,
    /// Spearman's rank correlation of predicted and actual ranges; `None` if one of the two does not vary.
    pub spearman: Option<f64>,
    /// p value of the rank correlation for the effective number of independent pairs; `None` if that number is below three.
    pub p: Option<f64>,
    /// p value of Mann and Whitney's test of the model's errors against those of the random baseline, on scans that are far enough from
    /// each other to be nearly independent.
    pub mann_whitney_p: f64,
}

/// The errors of a sensorgraph and of baselines on a log.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluation {
    /// Mean absolute error of the model over all segments of all scans, metres.
    pub mean_absolute_error_m: f64,
    /// Standard error of the mean absolute error, metres. It is computed from the means of ten parts of the path, because the errors
    /// of neighbouring scans are correlated.
    pub standard_error_m: f64,
    /// Mean absolute error of the segment's mean over the log of the fit, metres.
    pub baseline_constant_m: f64,
    /// Mean absolute error of the reading at the nearest logged pose, a radian of heading counting as a metre; metres.
    pub baseline_nearest_m: Option<f64>,
    /// Mean absolute error of the reading at the nearest logged position, turned to the heading (the log used as a map), metres.
    pub baseline_nearest_turned_m: Option<f64>,
    /// Mean absolute error of ideal beams in an arena, metres; `None` without an arena.
    pub baseline_ray_casting_m: Option<f64>,
    /// Mean absolute error of the random baseline, metres: numbers that are drawn uniformly from the interval of the log's ranges.
    pub baseline_random_m: f64,
    /// Spearman's rank correlation of predicted and actual ranges, all segments together.
    pub spearman: Option<f64>,
    /// p value of the rank correlation for the effective number of independent pairs of the segment that has most of them; the
    /// segments of one scan are not counted separately.
    pub p: Option<f64>,
    /// p value of Mann and Whitney's test of the model's errors against those of the random baseline, on one scan in `every`.
    pub mann_whitney_p: f64,
    /// Number of scans after which the errors of every segment are nearly independent.
    pub every: usize,
    /// Number of scans of the log.
    pub scans: usize,
    /// Number of segments, over all scans, in which a beam returned.
    pub samples: usize,
    /// Share of scans at positions outside of the rectangle that contains the log of the fit.
    pub outside: f64,
    /// The errors in each segment.
    pub segments: Vec<SegmentReport>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// The actual range of one segment of one scan, and the predictions of the model and of each baseline.
struct Sample {
    segment: usize,
    scan: usize,
    actual_m: f64,
    predicted_m: f64,
    constant_m: f64,
    random_m: f64,
    nearest_m: Option<f64>,
    turned_m: Option<f64>,
    cast_m: Option<f64>,
}

/// Number of parts of the path whose means are treated as independent.
const PARTS: usize = 10;

impl Evaluation {
    /// Evaluates the model on a log. With an arena, ideal beams that are cast in it are a further baseline.
    ///
    /// # Errors
    /// A log whose beams do not cover the model's segments, or in which no beam returned.
    pub fn new(
        model: &Sensorgraph,
        log: &ScanLog,
        arena: Option<&Arena>,
        seed: u64,
    ) -> Result<Self> {
        let samples = samples(model, log, arena, seed);
        if samples.is_empty() {
            return Err(
                Error::invalid("the log has no range in any segment of the model").hint(
                    "check that the beams of this log have the directions to which the model was fitted",
                ),
            );
        }
        let all: Vec<&Sample> = samples.iter().collect();
        let whole = errors(&all);
        let by_segment: Vec<(f64, Vec<&Sample>)> = model
            .segments_deg
            .iter()
            .enumerate()
            .map(|(segment, degrees)| {
                let own = samples.iter().filter(|s| s.segment == segment);
                (*degrees, own.collect())
            })
            .filter(|(_, own): &(f64, Vec<&Sample>)| !own.is_empty())
            .collect();
        let segments: Vec<SegmentReport> = by_segment
            .iter()
            .map(|(degrees, own)| segment_report(*degrees, own))
            .collect::<Result<_>>()?;
        let every = segments
            .iter()
            .map(|s| s.scans_per_error.ceil() as usize)
            .fold(1, usize::max);
        let mann_whitney_p = against_random(&all, |s| s.scan % every == 0)?;
        let pairs = by_segment.iter().map(|(_, own)| effective_pairs(own));
        let (rank, p) = ranks(&all, pairs.fold(0.0, f64::max));
        let within = log.scans.iter().filter(|scan| {
            let [u, v] = model.scaled(scan.position_world_m);
            let (low, high) = model.extent();
            (low[0]..=high[0]).contains(&u) && (low[1]..=high[1]).contains(&v)
        });
        let outside = 1.0 - within.count() as f64 / log.scans.len() as f64;
        let mut warnings = Vec::new();
        if outside > 0.0 {
            warnings.push(Code::Extrapolated.warning(format!(
                "{:.1} % of the scans were taken outside of the positions to which the model was fitted",
                100.0 * outside
            )));
        }
        if let Some(arena) = arena {
            let inside = log
                .scans
                .iter()
                .filter(|scan| arena.check_place(scan.position_world_m, 0.0).is_err());
            let inside = inside.count();
            if inside > 0 {
                warnings.push(Code::InsideWall.warning(format!(
                    "{inside} of {} scans were taken inside of a wall of the arena, or outside of its field: check that this is the arena of the log",
                    log.scans.len()
                )));
            }
        }
        let baseline_constant_m = mean(&whole(|s| Some(s.constant_m)));
        let mean_absolute_error_m = mean(&whole(|s| Some(s.predicted_m)));
        if mean_absolute_error_m >= baseline_constant_m {
            warnings.push(
                Code::BaselineNotBeaten
                    .warning("the model predicts no better than the mean of each segment"),
            );
        }
        let optional = |of: fn(&Sample) -> Option<f64>| {
            let found = whole(of);
            (!found.is_empty()).then(|| mean(&found))
        };
        let (nearest_m, turned_m) = (optional(|s| s.nearest_m), optional(|s| s.turned_m));
        if !model.frame.is_lookup() {
            let tried = [(Frame::Nearest, nearest_m), (Frame::Turned, turned_m)];
            warnings.extend(better_lookup(mean_absolute_error_m, &tried));
        }
        Ok(Self {
            mean_absolute_error_m,
            standard_error_m: by_parts(&all, log.scans.len()),
            baseline_constant_m,
            baseline_nearest_m: nearest_m,
            baseline_nearest_turned_m: turned_m,
            baseline_ray_casting_m: optional(|s| s.cast_m),
            baseline_random_m: mean(&whole(|s| Some(s.random_m))),
            spearman: rank,
            p,
            mann_whitney_p,
            every,
            scans: log.scans.len(),
            samples: samples.len(),
            outside,
            segments,
            warnings,
        })
    }
}

/// A warning if looking up the log predicts better than the model.
pub(super) fn better_lookup(model_m: f64, tried: &[(Frame, Option<f64>)]) -> Option<Warning> {
    let known = tried
        .iter()
        .filter_map(|(frame, error_m)| Some((frame, (*error_m)?)));
    let (frame, error_m) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (name, words) = match frame {
        Frame::Turned => ("turned", "place, turned to the heading,"),
        _ => ("nearest", "pose"),
    };
    (error_m < model_m).then(|| {
        Code::LookupBetter.warning(format!(
            "the scan at the nearest logged {words} has an error of {error_m:.3} m, the polynomials one of {model_m:.3} m: fit with the frame `{name}` to use it as the model"
        ))
    })
}

impl Sensorgraph {
    /// The rectangle of scaled positions that contains the log; the square from −1 to 1 if the model contains no log.
    fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let places = self
            .log
            .iter()
            .map(|pose| self.scaled([pose.pose.0, pose.pose.1]));
        let mut ends = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            // The log is rounded to millimetres.
            let rounding = 1e-3 / self.scale_m;
            for (low, value) in ends.0.iter_mut().zip(place) {
                *low = low.min(value - rounding);
            }
            for (high, value) in ends.1.iter_mut().zip(place) {
                *high = high.max(value + rounding);
            }
        }
        if self.log.is_empty() {
            ([-1.0; 2], [1.0; 2])
        } else {
            ends
        }
    }
}

/// Absolute errors of one of the predictions, for the samples that have one.
fn errors<'a>(samples: &'a [&Sample]) -> impl Fn(fn(&Sample) -> Option<f64>) -> Vec<f64> + 'a {
    move |of| {
        samples
            .iter()
            .filter_map(|s| Some((of(s)? - s.actual_m).abs()))
            .collect()
    }
}

/// p value of Mann and Whitney's test of the model's errors against those of the random baseline, on the samples that are `kept`; on
/// all samples if none is kept.
fn against_random(samples: &[&Sample], kept: impl Fn(&Sample) -> bool) -> Result<f64> {
    let thinned: Vec<&Sample> = samples.iter().copied().filter(|s| kept(s)).collect();
    let of = errors(if thinned.is_empty() {
        samples
    } else {
        &thinned
    });
    Ok(mann_whitney(&of(|s| Some(s.predicted_m)), &of(|s| Some(s.random_m)))?.p_value)
}

/// Predicted and actual ranges.
fn both(samples: &[&Sample]) -> (Vec<f64>, Vec<f64>) {
    samples.iter().map(|s| (s.predicted_m, s.actual_m)).unzip()
}

/// Effective number of independent pairs of predicted and actual ranges in one segment.
fn effective_pairs(samples: &[&Sample]) -> f64 {
    let (predicted, actual) = both(samples);
    independent_pairs(&predicted, &actual)
}

fn ranks(samples: &[&Sample], pairs: f64) -> (Option<f64>, Option<f64>) {
    let (predicted, actual) = both(samples);
    (
        spearman(&predicted, &actual).ok().map(|t| t.statistic),
        spearman_effective(&predicted, &actual, pairs)
            .ok()
            .map(|t| t.p_value),
    )
}

fn segment_report(segment_deg: f64, samples: &[&Sample]) -> Result<SegmentReport> {
    let of = errors(samples);
    let own = of(|s| Some(s.predicted_m));
    let optional = |of: Vec<f64>| (!of.is_empty()).then(|| mean(&of));
    let (rank, p) = ranks(samples, effective_pairs(samples));
    let scans_per_error = autocorrelation_time(&own);
    let every = scans_per_error.ceil() as usize;
    Ok(SegmentReport {
        segment_deg,
        samples: samples.len(),
        mean_absolute_error_m: mean(&own),
        standard_error_m: standard_deviation(&own) * (scans_per_error / own.len() as f64).sqrt(),
        scans_per_error,
        baseline_constant_m: mean(&of(|s| Some(s.constant_m))),
        baseline_nearest_m: optional(of(|s| s.nearest_m)),
        baseline_ray_casting_m: optional(of(|s| s.cast_m)),
        spearman: rank,
        p,
        mann_whitney_p: against_random(samples, |s| s.scan % every == 0)?,
    })
}

/// Standard error of the mean absolute error, from the means of parts of the path.
fn by_parts(samples: &[&Sample], scans: usize) -> f64 {
    let part = |scan: usize| scan * PARTS / scans;
    let means: Vec<f64> = (0..PARTS)
        .filter_map(|wanted| {
            let own: Vec<&Sample> = samples
                .iter()
                .copied()
                .filter(|s| part(s.scan) == wanted)
                .collect();
            (!own.is_empty()).then(|| mean(&errors(&own)(|s| Some(s.predicted_m))))
        })
        .collect();
    standard_deviation(&means) / (means.len() as f64).sqrt()
}

fn samples(model: &Sensorgraph, log: &ScanLog, arena: Option<&Arena>, seed: u64) -> Vec<Sample> {
    let ideal = arena.map(|arena| log.cast_in(arena));
    let mut rng = Once::RandomGuess.generator(seed);
    let known = model
        .log
        .iter()
        .flat_map(|pose| &pose.segments_m)
        .copied()
        .filter(|m| *m != NOTHING);
    let (low, high) = ends(known);
    let limits = model.polynomials.iter().map(|p| p.limits_m);
    let (low, high) = if low <= high {
        (low, high)
    } else {
        limits.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| {
            (a.0.min(b.0), a.1.max(b.1))
        })
    };
    let width = model.width_deg.to_radians();
    let mut samples = Vec::new();
    for (index, scan) in log.scans.iter().enumerate() {
        let pose = model.nearest_pose(scan.position_world_m, scan.heading_rad);
        let place = model.nearest_place(scan.position_world_m);
        for (segment, degrees) in model.segments_deg.iter().enumerate() {
            let Some(actual_m) = log.median_m(scan, degrees.to_radians(), width) else {
                continue;
            };
            samples.push(Sample {
                segment,
                scan: index,
                actual_m,
                predicted_m: model.range_m(scan.position_world_m, scan.heading_rad, segment),
                constant_m: model.means_m[segment],
                random_m: low + (high - low) * rng.random::<f64>(),
                nearest_m: pose.and_then(|pose| model.read_at(pose, segment)),
                turned_m: place.and_then(|place| model.turned_at(place, scan.heading_rad, segment)),
                cast_m: ideal.as_ref().and_then(|ideal| {
                    ideal.median_m(&ideal.scans[index], degrees.to_radians(), width)
                }),
            });
        }
    }
    samples
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let metres = |v: Option<f64>| v.map_or("–".to_owned(), |v| format!("{v:.3} m"));
        writeln!(f, "{} scans, {} segments\n", self.scans, self.samples)?;
        let cast = self
            .baseline_ray_casting_m
            .map(|m| ("  ideal beams in the arena", Some(m)));
        let rows = [
            ("  the model", Some(self.mean_absolute_error_m)),
            ("  each segment's mean", Some(self.baseline_constant_m)),
            ("  the nearest logged pose", self.baseline_nearest_m),
            (
                "  the nearest logged place, turned to the heading",
                self.baseline_nearest_turned_m,
            ),
            ("  random numbers", Some(self.baseline_random_m)),
        ];
        let table = TextTable::of(
            rows.iter().chain(&cast),
            &[
                ("  prediction", Left, &|row| row.0.to_owned()),
                ("mean absolute error", Right, &|row| metres(row.1)),
            ],
        );
        f.write_str(&table.render(false))?;
        writeln!(
            f,
            "standard error of the model's error, from parts of the path: {:.3} m",
            self.standard_error_m
        )?;
        if let (Some(rank), Some(p)) = (self.spearman, self.p) {
            writeln!(
                f,
                "rank correlation of predicted and actual ranges: {rank:.3} (p = {})",
                number(p)
            )?;
        }
        writeln!(
            f,
            "Mann-Whitney test of the model's errors against those of random numbers, with one scan in {}: p = {}\n",
            self.every,
            number(self.mann_whitney_p)
        )?;
        let table = TextTable::of(
            &self.segments,
            &[
                ("  segment", Right, &|s| format!("{:.0}°", s.segment_deg)),
                ("scans", Right, &|s| s.samples.to_string()),
                ("model", Right, &|s| metres(Some(s.mean_absolute_error_m))),
                ("± standard error", Left, &|s| {
                    metres(Some(s.standard_error_m))
                }),
                ("mean", Right, &|s| metres(Some(s.baseline_constant_m))),
                ("nearest", Right, &|s| metres(s.baseline_nearest_m)),
                ("rank correlation", Right, &|s| {
                    s.spearman.map_or("–".to_owned(), |r| format!("{r:.3}"))
                }),
                ("p", Right, &|s| s.p.map_or("–".to_owned(), number)),
                ("p against random", Right, &|s| number(s.mann_whitney_p)),
            ],
        );
        f.write_str(table.render(false).trim_end())
    }
}
