//! Pictures of task times: figure 13 of paper 002, and curves of Kaplan and Meier.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_sensing::task::{SideReport, TaskComparison};

/// How far from the middle of its condition a world is drawn.
const ASIDE: f64 = 0.12;

/// Medians and quartiles of every condition, real beside simulated.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_task_times(found: &TaskComparison, path: impl AsRef<Path>) -> Result<()> {
    let numbered = || found.conditions.iter().zip(1..);
    let names = numbered().map(|(c, number)| format!("{number}: {}", c.condition));
    let mut subtitle = names.collect::<Vec<_>>().join("; ");
    let never = numbered().flat_map(|(c, number)| {
        let sides = [(&c.real, "real"), (&c.simulated, "simulated")];
        let never = sides
            .into_iter()
            .filter(|(side, _)| side.median_s.is_none());
        never.map(move |(_, world)| format!("{number} {world}"))
    });
    let never: Vec<String> = never.collect();
    if !never.is_empty() {
        subtitle += &format!("; not half finished: {}", never.join(", "));
    }
    let mut series = Vec::new();
    for (colour, label) in ["real", "simulated"].into_iter().enumerate() {
        let sides = found.conditions.iter().enumerate().map(|(index, c)| {
            let side = if colour == 0 { &c.real } else { &c.simulated };
            let aside = if colour == 0 { -ASIDE } else { ASIDE };
            (1.0 + index as f64 + aside, side)
        });
        let sides: Vec<(f64, &SideReport)> = sides.collect();
        let medians = sides.iter();
        let medians = medians.filter_map(|(x, side)| Some((*x, side.median_s?)));
        let label = format!("{label}: median, quartiles");
        series.push(Series::new(label, SeriesKind::Dots, medians.collect()).colour(colour));
        for (x, side) in &sides {
            if let (Some(low), Some(high)) = (side.quartile_low_s, side.quartile_high_s) {
                let ends = vec![(*x, low), (*x, high)];
                series.push(Series::new("", SeriesKind::Line, ends).colour(colour));
            }
        }
    }
    // The axis of times begins at 0, and no condition stands on the frame.
    let level = vec![(0.5, 0.0), (found.conditions.len() as f64 + 0.5, 0.0)];
    series.push(Series::new("", SeriesKind::Level, level));
    let plot = LinePlot::new(
        Caption::new("Task times, real and simulated", subtitle),
        AxisSpec::new("condition", Unit::One).whole(),
        ("time", Unit::Second),
        series,
    );
    draw_lines(&plot, path)
}

/// The share that is not finished over time, every condition in a colour, simulated dashed.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_task_curves(found: &TaskComparison, path: impl AsRef<Path>) -> Result<()> {
    let conditions = found.conditions.iter();
    let sides = conditions.flat_map(|c| [&c.real, &c.simulated]);
    let last = sides.flat_map(|side| side.curve.times_s.last().copied());
    let end_s = last.fold(0.0, f64::max);
    let steps = |side: &SideReport| {
        let mut points = vec![(0.0, 1.0)];
        let mut share = 1.0;
        for (time, after) in side.curve.times_s.iter().zip(&side.curve.shares) {
            points.extend([(*time, share), (*time, *after)]);
            share = *after;
        }
        // Who gave up is not finished to the end.
        points.push((end_s, share));
        points
    };
    let series = found.conditions.iter().enumerate().flat_map(|(colour, c)| {
        let of = |side: &SideReport, world: &str, kind: SeriesKind| {
            Series::new(format!("{}, {world}", c.condition), kind, steps(side)).colour(colour)
        };
        [
            of(&c.real, "real", SeriesKind::Line),
            of(&c.simulated, "simulated", SeriesKind::Dashed),
        ]
    });
    let title = "Share of trials that are not finished";
    let plot = LinePlot {
        y_range: Some((0.0, 1.05)),
        ..LinePlot::new(
            Caption::new(title, "Kaplan and Meier; simulated dashed"),
            AxisSpec::new("time", Unit::Second),
            ("share not finished", Unit::One),
            series.collect(),
        )
    };
    draw_lines(&plot, path)
}
