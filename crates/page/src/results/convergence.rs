//! `convergence.png` and `trials.csv`: how an optimizer found its answer.

use std::path::Path;

use super::table::{number, write};
use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_lab::calibration::{Answer, PointScore, Study, Tuned};

/// Best score after each point; `None` until one has a score.
fn best_so_far(points: &[PointScore]) -> Vec<Option<f64>> {
    let mut best: Option<f64> = None;
    points
        .iter()
        .map(|point| {
            best = match (best, point.score) {
                (Some(best), Some(score)) => Some(best.min(score)),
                (best, score) => best.or(score),
            };
            best
        })
        .collect()
}

/// The runs that the optimizer asked for, without those that complete the settings of the best point.
fn chosen<'a>(answer: &'a Answer, tuned: &Tuned) -> &'a [PointScore] {
    let runs = &answer.scores.runs;
    &runs[..runs.len().min(tuned.evaluated)]
}

/// The score of every trial and the best so far, over the number of simulations.
pub(super) fn draw(
    folder: &Path,
    study: &Study,
    answer: &Answer,
    tuned: &Tuned,
    subtitle: &str,
) -> Result<()> {
    let points = chosen(answer, tuned);
    let numbered = |values: Vec<Option<f64>>| -> Vec<(f64, f64)> {
        let count = 1..=values.len();
        count
            .zip(values)
            .filter_map(|(n, value)| Some((n as f64, value?)))
            .collect()
    };
    let trials = numbered(points.iter().map(|point| point.score).collect());
    if trials.is_empty() {
        return Ok(());
    }
    let highest = trials.iter().map(|(_, score)| *score).fold(0.0, f64::max);
    let lowest = trials
        .iter()
        .map(|(_, score)| *score)
        .fold(f64::INFINITY, f64::min);
    let mut series = vec![
        Series {
            label: "each point".to_owned(),
            points: trials,
            kind: SeriesKind::Dots,
            colour: 4,
        },
        Series {
            label: "best so far".to_owned(),
            points: numbered(best_so_far(points)),
            kind: SeriesKind::Steps,
            colour: 1,
        },
    ];
    if tuned.design > 0 {
        let x = tuned.design as f64 + 0.5;
        series.push(Series {
            label: "end of the space-filling first design".to_owned(),
            points: vec![(x, lowest), (x, highest)],
            kind: SeriesKind::Level,
            colour: 0,
        });
    }
    let plot = LinePlot {
        caption: Caption::new(
            format!(
                "{}: what {} found, point by point",
                study.definition().name,
                tuned.optimizer
            ),
            subtitle,
        ),
        x: AxisSpec::new("points evaluated", Unit::One),
        y_label: format!("{} discrepancy", study.definition().metric.name()),
        y_unit: answer.scores.unit,
        scale: ScoreScale::Auto,
        y_range: None,
        series,
    };
    draw_lines(&plot, folder.join("convergence.png"))?;
    draw_lines(&plot, folder.join("convergence.svg"))
}

/// One row a trial in the order of evaluation.
pub(super) fn write_trials(
    folder: &Path,
    study: &Study,
    answer: &Answer,
    tuned: &Tuned,
) -> Result<()> {
    let names = study
        .definition()
        .grid
        .ranges()
        .iter()
        .map(|range| range.parameter.name);
    let header: Vec<&str> = ["trial", "phase"]
        .into_iter()
        .chain(names)
        .chain(["score", "unit", "best_so_far"])
        .collect();
    let points = chosen(answer, tuned);
    let rows = points.iter().zip(best_so_far(points)).map(|(point, best)| {
        let phase = if point.index < tuned.design {
            "design"
        } else {
            "search"
        };
        let mut row = vec![point.index.to_string(), phase.to_owned()];
        row.extend(point.values.iter().map(f64::to_string));
        row.push(number(point.score));
        row.push(answer.scores.unit.label().to_owned());
        row.push(number(best));
        row
    });
    write(&folder.join("trials.csv"), &header, rows)
}
