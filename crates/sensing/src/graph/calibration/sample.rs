//! Prepares a log of scans for the fit: the samples of each polynomial, the segments and the scale.

use super::option::GraphOptions;
use super::scan::ScanLog;
use crate::graph::model::{Frame, LoggedPose, NOTHING, Sensorgraph};
use realgap_core::error::{Error, Result};
use realgap_core::statistics::mean;

/// Largest number of poses that are kept in the model for the baselines.
const MOST_POSES: usize = 2000;

/// A sample of one polynomial: scaled position, range, and position along the path (0 to 1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) place: [f64; 2],
    pub(super) range_m: f64,
    pub(super) way: f64,
}

/// The smallest and the largest of some values.
pub(super) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// A sensorgraph with the segments, scale and means of a log, but without polynomials.
pub(super) fn frame_of_log(log: &ScanLog, options: &GraphOptions) -> Result<Sensorgraph> {
    let of = |axis: usize| {
        log.scans
            .iter()
            .map(move |scan| scan.position_world_m[axis])
    };
    let ((x0, x1), (y0, y1)) = (ends(of(0)), ends(of(1)));
    let scale_m = 0.5 * (x1 - x0).max(y1 - y0);
    if scale_m < 1e-3 {
        return Err(Error::invalid(
            "the robot never moved: a sensorgraph needs scans at different positions",
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
        return Err(Error::invalid("no beam of the log returned a range"));
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

/// Middles of the segments, degrees: all round from straight ahead, or from the rightmost beam to the leftmost.
fn segments(log: &ScanLog, width_deg: f64) -> Vec<f64> {
    if log.is_all_round() {
        let count = (360.0 / width_deg).round().max(1.0) as usize;
        return (0..count).map(|k| (k as f64 + 0.5) * width_deg).collect();
    }
    let (least, most) = ends(log.beams_rad.iter().copied());
    let (least, most) = (least.to_degrees(), most.to_degrees());
    let count = ((most - least) / width_deg).round().max(1.0) as usize;
    (0..count)
        .map(|k| least + (k as f64 + 0.5) * width_deg)
        .collect()
}

/// The samples of every polynomial from the scans that are `used`.
pub(super) fn samples(log: &ScanLog, graph: &Sensorgraph, used: &[bool]) -> Vec<Vec<Sample>> {
    let segments = graph.segments_deg.len();
    let count = match graph.frame {
        Frame::Robot => graph.headings * segments,
        Frame::World => graph.headings,
        Frame::Nearest | Frame::Turned => 0,
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
            Frame::Nearest | Frame::Turned => {}
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

/// Whether the beams cover the whole segment.
fn is_seen(log: &ScanLog, centre_rad: f64, width_rad: f64) -> bool {
    if log.is_all_round() {
        return true;
    }
    let (least, most) = ends(log.beams_rad.iter().copied());
    let centre = crate::graph::angle::wrapped(centre_rad);
    centre - 0.5 * width_rad >= least - 0.02 && centre + 0.5 * width_rad <= most + 0.02
}

/// The poses of the log with their medians; a long log is thinned evenly.
pub(super) fn logged(log: &ScanLog, graph: &Sensorgraph) -> Vec<LoggedPose> {
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
