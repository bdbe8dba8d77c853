//! Prepared trajectories over time. They show what a picture from above does not: the pace of straight walks, and the height of
//! tosses.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, Series, SeriesKind, Stack, StackRow, draw_stack};
use realgap_core::error::{Error, Result};
use realgap_core::unit::Unit;
use realgap_path::trajectory::{POINTS, Prepared};

/// A prepared trajectory with its name and how long it takes.
#[derive(Debug, Clone, Copy)]
pub struct Timed<'a> {
    /// What it is called in the legend.
    pub name: &'a str,
    /// The trajectory.
    pub path: &'a Prepared,
    /// From its first to its last point, seconds.
    pub duration_s: f64,
}

/// Along, across, height and distance from the first of them, over time. Height only where it was recorded.
///
/// # Errors
/// No trajectory, a path that is no picture's, a full disk.
pub fn draw_over_time(all: &[Timed<'_>], subtitle: &str, path: impl AsRef<Path>) -> Result<()> {
    let Some((reference, others)) = all.split_first() else {
        return Err(Error::invalid("there is no trajectory to draw"));
    };
    let row = |label: &str, of: &dyn Fn(&Timed<'_>, usize) -> Option<f64>, from: &[Timed<'_>]| {
        let first = all.len() - from.len();
        let series = from.iter().enumerate().filter_map(|(index, timed)| {
            let values: Option<Vec<f64>> = (0..POINTS).map(|k| of(timed, k)).collect();
            let time_s = |k: usize| timed.duration_s * k as f64 / (POINTS - 1) as f64;
            let points = values?.into_iter().enumerate();
            let kind = match first + index {
                0 => SeriesKind::Line,
                _ => SeriesKind::Thin,
            };
            let points = points.map(|(k, value)| (time_s(k), value)).collect();
            Some(Series::new(timed.name, kind, points).colour(first + index))
        });
        let series: Vec<Series> = series.collect();
        (!series.is_empty()).then(|| StackRow {
            x: None,
            y_label: label.to_owned(),
            y_unit: Unit::Metre,
            series,
        })
    };
    let xy = |timed: &Timed<'_>, k: usize| timed.path.xy_m().get(k).copied();
    let z = |timed: &Timed<'_>, k: usize| timed.path.z_m()?.get(k).copied();
    let away = |timed: &Timed<'_>, k: usize| {
        let ([x, y], [to_x, to_y]) = (xy(timed, k)?, xy(reference, k)?);
        let rise = z(timed, k).zip(z(reference, k)).map_or(0.0, |(a, b)| a - b);
        Some((x - to_x).hypot(y - to_y).hypot(rise))
    };
    let rows = [
        row("ahead", &|timed, k| Some(xy(timed, k)?[0]), all),
        row("to the left", &|timed, k| Some(xy(timed, k)?[1]), all),
        row("height", &z, all),
        row("distance", &away, others),
    ];
    let title = format!("over time, distances from {}", reference.name);
    let stack = Stack {
        caption: Caption::new(title, subtitle),
        x: AxisSpec::new("time", Unit::Second),
        rows: rows.into_iter().flatten().collect(),
    };
    draw_stack(&stack, path)
}
