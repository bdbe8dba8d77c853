//! Pictures of a characterised sensor: figures 3 and 4 of paper 000.

use std::path::Path;

use crate::plot::{
    AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, Stack, StackRow, draw_lines,
    draw_stack,
};
use realgap_core::error::{Error, Result};
use realgap_core::unit::{LengthUnit, Unit, number};
use realgap_sensing::belief::{BeliefReport, DistanceBelief, TrialSet};
use realgap_sensing::graph::{Scan, ScanLog, Sensorgraph};
use realgap_sensing::range::{
    Beam, Characterisation, DistanceReport, RangeSensor, ReadingLog, ReadingUnit,
};

/// Points of a drawn curve.
const POINTS: usize = 300;

/// `reading (cm)`.
fn reading_label(what: &str, unit: &ReadingUnit) -> String {
    match unit.symbol() {
        "" => format!("{what} (the sensor's own unit)"),
        symbol => format!("{what} ({symbol})"),
    }
}

fn distance_axis(unit: LengthUnit) -> AxisSpec {
    AxisSpec::new(format!("distance ({})", unit.symbol()), Unit::One)
}

/// Mean and spread over the distance: what was read and the model, as figure 4.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_sensor(found: &Characterisation, path: impl AsRef<Path>) -> Result<()> {
    let model = &found.model;
    let (low, high) = model.range;
    let metres = model.distance_unit.metres();
    let along = (0..=POINTS).map(|i| low + (high - low) * i as f64 / POINTS as f64);
    let along: Vec<f64> = along.collect();
    let beam = |d: &f64| Beam::straight(d * metres);
    let of = |value: &dyn Fn(&f64) -> f64| along.iter().map(|d| (*d, value(d))).collect::<Vec<_>>();
    let (mean, sd) = (|d: &f64| model.mean(&beam(d)), |d: &f64| model.sd(&beam(d)));
    let read = |value: fn(&DistanceReport) -> Option<f64>| -> Vec<(f64, f64)> {
        let distances = found.distances.iter();
        let read = distances.filter_map(|d| Some((d.distance, value(d)?)));
        read.collect()
    };
    // Logarithmic like most such curves, unless the band goes below 0.
    let is_positive = along.iter().all(|d| mean(d) - 1.645 * sd(d) > 0.0);
    let upper = along.iter().map(|d| mean(d) + 1.645 * sd(d)).collect();
    let lower = of(&|d| mean(d) - 1.645 * sd(d));
    let subtitle = format!(
        "{}; mean: {}, spread: {}",
        model.description, found.mean_form, found.spread_form
    );
    let plot = LinePlot {
        scale: match is_positive {
            true => ScoreScale::Auto,
            false => ScoreScale::Linear,
        },
        ..LinePlot::new(
            Caption::new("Mean and spread of readings", subtitle),
            distance_axis(model.distance_unit),
            (&reading_label("reading", &model.reading_unit), Unit::One),
            vec![
                Series::new("90 % of readings", SeriesKind::Band(upper), lower),
                Series::new("mean, model", SeriesKind::Line, of(&mean)),
                Series::new("mean, read", SeriesKind::Dots, read(|d| d.mean)),
                Series::new("standard deviation, model", SeriesKind::Line, of(&sd)).colour(1),
                Series::new("standard deviation, read", SeriesKind::Dots, read(|d| d.sd)).colour(1),
            ],
        )
    };
    draw_lines(&plot, path)
}

/// The distances of the histograms where none are named: near both ends and the middle.
fn usual_distances(found: &Characterisation) -> Vec<f64> {
    let several = found.distances.iter().filter(|d| d.readings > 1);
    let mut distances: Vec<f64> = several.map(|d| d.distance).collect();
    distances.dedup();
    let last = distances.len().saturating_sub(1);
    let places = [last / 20, last / 2, last - last / 20].into_iter();
    let mut chosen: Vec<f64> = places.filter_map(|i| distances.get(i).copied()).collect();
    chosen.dedup();
    chosen
}

/// Histograms at some distances with the model's density, as figure 3. Areas are 1.
///
/// # Errors
/// A distance of which the log has no readings, a path that is no picture's, a full disk.
pub fn draw_histograms(
    found: &Characterisation,
    log: &ReadingLog,
    at: &[f64],
    bin: Option<f64>,
    path: impl AsRef<Path>,
) -> Result<()> {
    let model = &found.model;
    let at = match at {
        [] => usual_distances(found),
        named => named.to_vec(),
    };
    let length = model.distance_unit.symbol();
    let (mut bars, mut lines) = (Vec::new(), Vec::new());
    for (colour, distance) in at.iter().enumerate() {
        let near = 1e-9 * distance.abs().max(1.0);
        let same = log.readings.iter();
        let same = same.filter(|r| (r.distance - distance).abs() < near);
        let values: Vec<f64> = same.filter_map(|r| r.value).collect();
        if values.is_empty() {
            return Err(Error::usage("the log has no readings at this distance")
                .field("distance of a histogram")
                .found(format!("{distance} {length}")));
        }
        let beam = Beam::straight(distance * model.distance_unit.metres());
        let (mean, sd) = (model.mean(&beam), model.sd(&beam));
        let width = bin.unwrap_or(0.2 * sd);
        let (stairs, zeros) = stairs(&values, width, (mean - 8.0 * sd, mean + 8.0 * sd));
        let label = format!("{distance} {length}: {} readings", values.len());
        bars.push(Series::new(label, SeriesKind::Band(zeros), stairs).colour(colour));
        let density = (0..=POINTS).map(|i| {
            let z = -4.0 + 8.0 * i as f64 / POINTS as f64;
            let reading = mean + z * sd;
            (reading, libm::exp(model.log_density(reading, &beam)))
        });
        let label = format!("{distance} {length}: model");
        lines.push(Series::new(label, SeriesKind::Line, density.collect()).colour(colour));
    }
    bars.extend(lines);
    let plot = LinePlot::new(
        Caption::new("Readings at known distances", model.description.clone()),
        AxisSpec::new(reading_label("reading", &model.reading_unit), Unit::One),
        ("density", Unit::One),
        bars,
    );
    draw_lines(&plot, path)
}

/// Outline of a histogram between two ends, and its foot.
fn stairs(values: &[f64], width: f64, (low, high): (f64, f64)) -> (Vec<(f64, f64)>, Vec<f64>) {
    let first = (low / width).floor() as i64;
    let count = ((high / width).ceil() as i64 - first).clamp(1, 2000) as usize;
    let mut counts = vec![0_usize; count];
    for value in values {
        let place = (value / width).floor() as i64 - first;
        let bin = usize::try_from(place).ok();
        if let Some(bin) = bin.and_then(|place| counts.get_mut(place)) {
            *bin += 1;
        }
    }
    let mut points = Vec::new();
    for (index, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let height = *count as f64 / (values.len() as f64 * width);
        let left = (first + index as i64) as f64 * width;
        points.extend([(left, height), (left + width, height), (f64::NAN, f64::NAN)]);
    }
    let zeros = vec![0.0; points.len()];
    (points, zeros)
}

/// Predicted and actual ranges of one segment along the way: figures 10 to 15 of paper 001.
///
/// # Errors
/// No such segment, a path that is no picture's, a full disk.
pub fn draw_segment(
    model: &Sensorgraph,
    log: &ScanLog,
    segment: usize,
    path: impl AsRef<Path>,
) -> Result<()> {
    let Some(degrees) = model.segments_deg.get(segment) else {
        return Err(Error::usage("the model has no such segment")
            .field("segment")
            .found(segment)
            .allowed(format!("0 to {}", model.segments_deg.len() - 1)));
    };
    let (centre, width) = (degrees.to_radians(), model.width_deg.to_radians());
    let along = |of: &dyn Fn(&Scan) -> f64| -> Vec<(f64, f64)> {
        let since = |scan: &Scan| scan.time_s - log.scans[0].time_s;
        log.scans.iter().map(|s| (since(s), of(s))).collect()
    };
    let actual = along(&|scan| log.median_m(scan, centre, width).unwrap_or(f64::NAN));
    let predicted = along(&|scan| model.range_m(scan.position_world_m, scan.heading_rad, segment));
    let title = format!("Range at {degrees:.0}° from straight ahead, along the way");
    let subtitle = "medians of a segment of the scan; the model has not seen this log unless it was fitted to it";
    let plot = LinePlot::new(
        Caption::new(title, subtitle),
        AxisSpec::new("time", Unit::Second),
        ("range", Unit::Metre),
        vec![
            Series::new("actual", SeriesKind::Dots, actual).colour(1),
            Series::new("predicted", SeriesKind::Line, predicted),
        ],
    );
    draw_lines(&plot, path)
}

/// Cells that are shown beside those that are believed in: a belief in one cell would be a dot.
const BESIDE: usize = 6;

/// Beliefs at every distance, of the model and of the log, a row each: figures 5 and 6 of paper 000.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_belief(found: &BeliefReport, path: impl AsRef<Path>) -> Result<()> {
    let (count, unit) = (found.readings, &found.unit);
    let rows = found.distances.iter().map(|side| StackRow {
        x: Some(AxisSpec::new(format!("distance ({unit})"), Unit::One)),
        y_label: format!("belief at {} {unit}", number(side.distance)),
        y_unit: Unit::One,
        series: belief(side),
    });
    let trials = found
        .distances
        .first()
        .map_or(0, |side| side.simulated.trials);
    let stack = Stack {
        caption: Caption::new(
            format!("Beliefs after {count} readings"),
            format!("discrete Bayes filter, {trials} trials; the probability of each cell"),
        ),
        x: AxisSpec::new(format!("distance ({unit})"), Unit::One),
        rows: rows.collect(),
    };
    draw_stack(&stack, path)
}

/// The beliefs at one distance, where anything is believed and a little beside.
fn belief(side: &DistanceBelief) -> Vec<Series> {
    let along = |values: &[f64]| -> Vec<(f64, f64)> {
        let cells = side.cells.iter().copied();
        cells.zip(values.iter().copied()).collect()
    };
    let mut all = Vec::new();
    let mut add = |name: &str, colour: usize, set: &TrialSet| {
        let (label, upper) = (format!("{name}: 90 % of trials"), set.q95.clone());
        let band = Series::new(label, SeriesKind::Band(upper), along(&set.q05));
        let label = format!("{name}: mean belief");
        let mean = Series::new(label, SeriesKind::Line, along(&set.mean));
        all.extend([band.colour(colour), mean.colour(colour)]);
    };
    add("model", 0, &side.simulated);
    if let Some(real) = &side.real {
        add("log", 1, real);
    }
    // Where nothing is believed nothing is drawn.
    let real = side.real.iter().flat_map(|r| &r.mean);
    let means = side.simulated.mean.iter().chain(real).copied();
    let most = means.fold(0.0, f64::max);
    let seen = |k: &usize| {
        let of = |set: &TrialSet| set.q95[*k] > 0.002 * most;
        of(&side.simulated) || side.real.as_ref().is_some_and(of)
    };
    let shown: Vec<usize> = (0..side.cells.len()).filter(seen).collect();
    if let (Some(first), Some(last)) = (shown.first(), shown.last()) {
        let first = first.saturating_sub(BESIDE);
        let last = (last + BESIDE).min(side.cells.len() - 1);
        for one in &mut all {
            if let SeriesKind::Band(upper) = &mut one.kind {
                *upper = upper[first..=last].to_vec();
            }
            one.points = one.points[first..=last].to_vec();
        }
    }
    all
}
