//! `convergence.png` and `trials.csv`: how an optimizer found its answer.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, both, draw_lines};
use crate::results::kind::file;
use crate::results::table::{names, number, texts, write};
use realgap_core::error::Result;
use realgap_core::statistics::ends_of;
use realgap_core::unit::Unit;
use realgap_lab::calibration::{Answer, PointScore, Study, Tuned};

/// Best score after each point; `None` until one has a score.
fn best_so_far(points: &[PointScore]) -> Vec<Option<f64>> {
    let mut best: Option<f64> = None;
    let scores = points.iter().map(|point| point.score);
    let so_far = scores.map(|score| {
        best = best
            .zip(score)
            .map(|(best, score)| best.min(score))
            .or(best)
            .or(score);
        best
    });
    so_far.collect()
}

/// The runs that the optimizer asked for, without those that complete the settings of the best point.
fn chosen<'a>(answer: &'a Answer, tuned: &Tuned) -> &'a [PointScore] {
    let runs = &answer.scores.runs;
    &runs[..runs.len().min(tuned.evaluated)]
}

/// The score of every trial and the best so far, over the number of simulations.
pub(in crate::results) fn draw(
    folder: &Path,
    study: &Study,
    answer: &Answer,
    tuned: &Tuned,
    subtitle: &str,
) -> Result<()> {
    let points = chosen(answer, tuned);
    let numbered = |values: Vec<Option<f64>>| -> Vec<(f64, f64)> {
        let all = (1..=values.len()).zip(values);
        let known = all.filter_map(|(n, value)| Some((n as f64, value?)));
        known.collect()
    };
    let trials = numbered(points.iter().map(|point| point.score).collect());
    if trials.is_empty() {
        return Ok(());
    }
    let (lowest, highest) = ends_of(trials.iter().map(|(_, score)| *score));
    let highest = highest.max(0.0);
    let best = numbered(best_so_far(points));
    let mut series = vec![
        Series::new("each point", SeriesKind::Dots, trials).colour(4),
        Series::new("best so far", SeriesKind::Steps, best).colour(1),
    ];
    if tuned.design > 0 {
        let x = tuned.design as f64 + 0.5;
        let label = "end of the space-filling first design";
        let ends = vec![(x, lowest), (x, highest)];
        series.push(Series::new(label, SeriesKind::Level, ends));
    }
    let definition = study.definition();
    let (name, found_by) = (&definition.name, tuned.optimizer);
    let caption = format!("{name}: what {found_by} found, point by point");
    let score = format!("{} discrepancy", definition.metric.name());
    let plot = LinePlot {
        scale: ScoreScale::Auto,
        ..LinePlot::new(
            Caption::new(caption, subtitle),
            AxisSpec::new("points evaluated", Unit::One),
            (&score, answer.scores.unit),
            series,
        )
    };
    both(folder, "convergence", |path| draw_lines(&plot, path))
}

/// One row a trial in the order of evaluation.
pub(in crate::results) fn write_trials(
    folder: &Path,
    study: &Study,
    answer: &Answer,
    tuned: &Tuned,
) -> Result<()> {
    let header = ["trial", "phase"].into_iter().chain(names(study));
    let header: Vec<&str> = header.chain(["score", "unit", "best_so_far"]).collect();
    let points = chosen(answer, tuned);
    let rows = points.iter().zip(best_so_far(points)).map(|(point, best)| {
        let is_design = point.index < tuned.design;
        let phase = if is_design { "design" } else { "search" };
        let first = vec![point.index.to_string(), phase.to_owned()];
        let unit = answer.scores.unit.label().to_owned();
        let last = vec![number(point.score), unit, number(best)];
        [first, texts(&point.values), last].concat()
    });
    write(&folder.join(file::TRIALS), &header, rows)
}
