//! The reliability diagram of predicted probabilities.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_lab::prediction::Odds;

/// Draws how often poses occurred over the probability that was predicted for them, with 95 % intervals.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_odds(odds: &Odds, name: &str, path: &Path) -> Result<()> {
    let along = |value: fn(&realgap_core::statistics::Proportion) -> f64| {
        let bins = odds.reliability.iter();
        bins.map(move |bin| (bin.probability, value(&bin.observed)))
    };
    let high = along(|observed| observed.high).map(|point| point.1);
    let kind = SeriesKind::Band(high.collect());
    let ends = vec![(0.0, 0.0), (1.0, 1.0)];
    let low = along(|observed| observed.low).collect();
    let observed = along(|observed| observed.share).collect();
    let title = format!("{name}: are the predicted probabilities reliable?");
    let subtitle = format!(
        "{} recordings, {} runs each; Brier score {:.3}; bands are 95 % intervals",
        odds.recordings, odds.runs, odds.brier.mean
    );
    let plot = LinePlot {
        y_range: Some((0.0, 1.0)),
        ..LinePlot::new(
            Caption::new(title, subtitle),
            AxisSpec::new("predicted probability of a pose", Unit::One),
            ("share of runs that ended in the pose", Unit::One),
            vec![
                Series::new("95 % interval", kind, low),
                Series::new("perfectly reliable", SeriesKind::Level, ends),
                Series::new("observed share", SeriesKind::Dots, observed),
            ],
        )
    };
    draw_lines(&plot, path)
}
