//! Where a log of scans has been: what a model of it can know. Figures 4 to 9 of paper 001.

use std::f64::consts::PI;
use std::path::Path;

use crate::plot::{
    AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, Stack, StackRow, draw_lines,
    draw_stack,
};
use realgap_core::error::Result;
use realgap_core::statistics::ends_of;
use realgap_core::unit::{Unit, counted};
use realgap_sensing::graph::ScanLog;

/// Bars of a histogram.
const BARS: usize = 24;

/// The way from above, a dot a scan: figures 4, 8 and 9.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_way(log: &ScanLog, path: impl AsRef<Path>) -> Result<()> {
    let points: Vec<(f64, f64)> = places(log).collect();
    let first = points.first().copied().into_iter().collect();
    let plot = LinePlot {
        scale: ScoreScale::LikeX,
        ..LinePlot::new(
            Caption::new("Where scans were taken", counted(points.len(), "scan")),
            AxisSpec::new("x", Unit::Metre),
            ("y", Unit::Metre),
            vec![
                Series::new("way", SeriesKind::Thin, points.clone()),
                Series::new("scan", SeriesKind::Dots, points),
                Series::new("start", SeriesKind::Dots, first).colour(1),
            ],
        )
    };
    draw_lines(&plot, path)
}

/// Histograms of x, y and heading: figures 5 to 7.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_visits(log: &ScanLog, path: impl AsRef<Path>) -> Result<()> {
    let (x, y): (Vec<f64>, Vec<f64>) = places(log).unzip();
    let turned =
        |scan: &realgap_sensing::graph::Scan| (scan.heading_rad + PI).rem_euclid(2.0 * PI) - PI;
    let headings_deg: Vec<f64> = log.scans.iter().map(|s| turned(s).to_degrees()).collect();
    let row = |axis: AxisSpec, values: &[f64], ends: Option<(f64, f64)>| {
        let (points, feet) = bars(values, ends);
        StackRow {
            x: Some(axis),
            y_label: "scans".to_owned(),
            y_unit: Unit::One,
            series: vec![Series::new("", SeriesKind::Band(feet), points)],
        }
    };
    let scans = counted(log.scans.len(), "scan");
    let subtitle = format!("{scans}; a model knows nothing of what was not visited");
    let (heading, all) = (
        AxisSpec::new("heading", Unit::Degree),
        Some((-180.0, 180.0)),
    );
    let stack = Stack {
        caption: Caption::new("How often each place and heading was visited", subtitle),
        x: AxisSpec::new("", Unit::One),
        rows: vec![
            row(AxisSpec::new("x", Unit::Metre), &x, None),
            row(AxisSpec::new("y", Unit::Metre), &y, None),
            row(heading, &headings_deg, all),
        ],
    };
    draw_stack(&stack, path)
}

fn places(log: &ScanLog) -> impl Iterator<Item = (f64, f64)> + '_ {
    log.scans.iter().map(|scan| {
        let [x, y] = scan.position_world_m;
        (x, y)
    })
}

/// Tops of bars from the lowest to the highest value, or between these ends, and their feet.
fn bars(values: &[f64], ends: Option<(f64, f64)>) -> (Vec<(f64, f64)>, Vec<f64>) {
    let (low, high) = ends_of(values.iter().copied());
    let (low, high) = ends.unwrap_or((low, if high > low { high } else { low + 1.0 }));
    let width = (high - low) / BARS as f64;
    let mut counts = [0_usize; BARS];
    for value in values {
        let bar = ((value - low) / width).floor();
        counts[(bar.max(0.0) as usize).min(BARS - 1)] += 1;
    }
    let mut points = Vec::with_capacity(3 * BARS);
    for (bar, count) in counts.into_iter().enumerate() {
        let (from, to) = (low + bar as f64 * width, low + (bar + 1) as f64 * width);
        // A gap, so that each bar is seen.
        let inset = 0.04 * width;
        let (from, to, top) = (from + inset, to - inset, count as f64);
        points.extend([(from, top), (to, top), (f64::NAN, f64::NAN)]);
    }
    let feet = vec![0.0; points.len()];
    (points, feet)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_stands_in_one_bar() {
        let values = [0.0, 0.1, 0.5, 1.0, 1.0];
        let (points, feet) = bars(&values, None);
        assert_eq!(points.len(), feet.len());
        let total: f64 = points.chunks(3).map(|bar| bar[0].1).sum();
        assert_eq!(total, 5.0);
        assert_eq!(points[3 * (BARS - 1)].1, 2.0);
        assert_eq!(bars(&[2.0], None).0[0].1, 1.0);
    }
}
