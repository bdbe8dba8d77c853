//! What reality may be, every parameter against every other.

use std::path::Path;

use super::cell::axis;
use crate::plot::{Caption, Corner, both, draw_corner};
use realgap_core::error::Result;
use realgap_core::unit::counted;
use realgap_lab::calibration::{Answer, Study};
use realgap_optimization::Range;

/// Draws of the inference, where there are two parameters or more.
pub(in crate::results) fn draw(
    folder: &Path,
    study: &Study,
    answer: &Answer,
    subtitle: &str,
) -> Result<()> {
    let definition = study.definition();
    let ranges = definition.grid.ranges();
    let Some(draws) = answer.draws.as_ref().filter(|_| ranges.len() > 1) else {
        return Ok(());
    };
    let draws = draws.rows().to_vec();
    if draws.len() < 2 {
        return Ok(());
    }
    let best = answer.scores.best;
    let best = best.map(|best| answer.scores.points[best].values.clone());
    let known = |range: &Range| definition.truth.value(range.parameter.name);
    let truth: Vec<Option<f64>> = ranges.iter().map(known).collect();
    let is_known = truth.iter().any(Option::is_some);
    let what = "what the recordings leave possible";
    let name = &definition.name;
    let title = format!("{name}: {what}, every parameter against every other");
    let subtitle = format!("{subtitle}; {}", counted(draws.len(), "draw"));
    let corner = Corner {
        caption: Caption::new(title, subtitle),
        axes: ranges.iter().map(axis).collect(),
        draws,
        best,
        truth: is_known.then(|| (truth, "hidden value of the stand-in".to_owned())),
    };
    both(folder, "corner", |path| draw_corner(&corner, path))
}
