//! The corner plot of the posterior: every parameter against every other.

use super::chart::parameter_axis;
use crate::plot::{Caption, Corner};
use crate::results::draft::Draft;
use realgap_core::error::Result;
use realgap_core::unit::counted;
use realgap_lab::calibration::{Answer, Study};
use realgap_optimization::Range;

/// Draws the posterior, where there are two parameters or more.
pub(super) fn draw(
    draft: &mut Draft,
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
    let what = "values that the recordings allow";
    let name = &definition.name;
    let title = format!("{name}: {what}, every parameter against every other");
    let subtitle = format!("{subtitle}; {}", counted(draws.len(), "draw"));
    let corner = Corner {
        caption: Caption::new(title, subtitle),
        axes: ranges
            .iter()
            .map(|range| parameter_axis(range.parameter.name))
            .collect(),
        draws,
        best,
        truth: is_known.then(|| (truth, "hidden value of the stand-in".to_owned())),
    };
    draft.draw("corner", &corner)
}
