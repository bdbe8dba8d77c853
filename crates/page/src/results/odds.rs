//! The reliability diagram of odds.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_lab::prediction::Odds;

/// Draws how often poses happened over the probability that they were given, with 95 % intervals.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_odds(odds: &Odds, name: &str, path: &Path) -> Result<()> {
    let along = |value: fn(&realgap_core::statistics::Proportion) -> f64| {
        let bins = odds.reliability.iter();
        bins.map(move |bin| (bin.probability, value(&bin.observed)))
    };
    let series = |label: &str, points: Vec<(f64, f64)>, kind: SeriesKind| Series {
        label: label.to_owned(),
        points,
        kind,
        colour: 0,
    };
    let high = along(|observed| observed.high)
        .map(|point| point.1)
        .collect();
    let plot = LinePlot {
        caption: Caption::new(
            format!("{name}: do odds keep what they promise?"),
            format!(
                "{} recordings, {} runs each; Brier score {:.3}; bands are 95 % intervals",
                odds.recordings, odds.runs, odds.brier.mean
            ),
        ),
        x: AxisSpec::new("probability given to a pose", Unit::One),
        y_label: "share that ended in it".to_owned(),
        y_unit: Unit::One,
        scale: ScoreScale::Linear,
        y_range: Some((0.0, 1.0)),
        series: vec![
            series(
                "95 % interval",
                along(|observed| observed.low).collect(),
                SeriesKind::Band(high),
            ),
            series(
                "as promised",
                vec![(0.0, 0.0), (1.0, 1.0)],
                SeriesKind::Level,
            ),
            series(
                "happened",
                along(|observed| observed.share).collect(),
                SeriesKind::Dots,
            ),
        ],
    };
    draw_lines(&plot, path)
}
