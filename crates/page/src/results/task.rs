//! Pictures of task times: figure 13 of paper 002, and curves of Kaplan and Meier.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_sense::task::{SideReport, TaskComparison};

/// How far from the middle of its condition a world is drawn.
const ASIDE: f64 = 0.12;

/// Medians and quartiles of every condition, real beside simulated.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_task_times(found: &TaskComparison, path: impl AsRef<Path>) -> Result<()> {
    let names: Vec<String> = found
        .conditions
        .iter()
        .enumerate()
        .map(|(index, c)| format!("{}: {}", index + 1, c.condition))
        .collect();
    let mut subtitle = names.join("; ");
    let never: Vec<String> = found
        .conditions
        .iter()
        .zip(1..)
        .flat_map(|(c, number)| {
            [
                (&c.real, number, "real"),
                (&c.simulated, number, "simulated"),
            ]
        })
        .filter(|(side, ..)| side.median_s.is_none())
        .map(|(_, number, world)| format!("{number} {world}"))
        .collect();
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
        series.push(Series {
            label: format!("{label}: median, quartiles"),
            points: sides
                .iter()
                .filter_map(|(x, side)| Some((*x, side.median_s?)))
                .collect(),
            kind: SeriesKind::Dots,
            colour,
        });
        for (x, side) in &sides {
            if let (Some(low), Some(high)) = (side.quartile_low_s, side.quartile_high_s) {
                series.push(Series {
                    label: String::new(),
                    points: vec![(*x, low), (*x, high)],
                    kind: SeriesKind::Line,
                    colour,
                });
            }
        }
    }
    // The axis of times begins at 0, and no condition stands on the frame.
    series.push(Series {
        label: String::new(),
        points: vec![(0.5, 0.0), (found.conditions.len() as f64 + 0.5, 0.0)],
        kind: SeriesKind::Level,
        colour: 0,
    });
    let plot = LinePlot {
        caption: Caption::new("Task times, real and simulated", subtitle),
        x: AxisSpec::new("condition", Unit::One).whole(),
        y_label: "time".to_owned(),
        y_unit: Unit::Second,
        scale: ScoreScale::Linear,
        y_range: None,
        series,
    };
    draw_lines(&plot, path)
}

/// The share that is not finished over time, every condition in a colour, simulated dashed.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_task_curves(found: &TaskComparison, path: impl AsRef<Path>) -> Result<()> {
    let sides = found
        .conditions
        .iter()
        .flat_map(|c| [&c.real, &c.simulated]);
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
        let of = |side: &SideReport, world: &str, kind: SeriesKind| Series {
            label: format!("{}, {world}", c.condition),
            points: steps(side),
            kind,
            colour,
        };
        [
            of(&c.real, "real", SeriesKind::Line),
            of(&c.simulated, "simulated", SeriesKind::Dashed),
        ]
    });
    let plot = LinePlot {
        caption: Caption::new(
            "Share of trials that are not finished",
            "Kaplan and Meier; simulated dashed",
        ),
        x: AxisSpec::new("time", Unit::Second),
        y_label: "share not finished".to_owned(),
        y_unit: Unit::One,
        scale: ScoreScale::Linear,
        y_range: Some((0.0, 1.05)),
        series: series.collect(),
    };
    draw_lines(&plot, path)
}
