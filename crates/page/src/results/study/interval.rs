//! The verdict as a picture: how far, what the recordings say of each parameter, and whether to trust it.

use crate::plot::{Caption, IntervalChart, ParameterInterval};
use crate::results::draft::Draft;
use realgap_core::error::Result;
use realgap_core::unit::number;
use realgap_lab::calibration::{Answer, Study, Verdict};
use realgap_lab::claim::{About, Claim};
use realgap_optimization::Range;

/// Draws the verdict, where there is one. `subtitle` says what was compared.
pub(super) fn draw(
    draft: &mut Draft,
    study: &Study,
    answer: &Answer,
    subtitle: &str,
) -> Result<()> {
    let report = &answer.report;
    if report.verdicts.is_empty() {
        return Ok(());
    }
    let definition = study.definition();
    let ranges = definition.grid.ranges().iter().zip(&report.verdicts);
    let rows = ranges.map(|(range, verdict)| {
        let truth = definition.truth.value(range.parameter.name);
        row(range, verdict, truth)
    });
    let said = |about| {
        report
            .claims
            .iter()
            .find(|claim: &&Claim| claim.about == about)
    };
    let title = said(About::Gap).map_or_else(
        || {
            format!(
                "{}: what the recordings say of the parameters",
                definition.name
            )
        },
        |gap| gap.text.clone(),
    );
    let below = match said(About::Trust) {
        Some(trust) => format!("{} ({subtitle})", trust.text),
        None => subtitle.to_owned(),
    };
    let chart = IntervalChart {
        caption: Caption::new(title, below),
        parameters: rows.collect(),
        truth_label: "hidden value of the stand-in".to_owned(),
    };
    draft.draw("verdict", &chart)
}

/// The row of one parameter.
fn row(range: &Range, verdict: &Verdict, truth: Option<f64>) -> ParameterInterval {
    let unit = range.parameter.unit.symbol();
    let end = |value: f64| format!("{} {unit}", number(value)).trim_end().to_owned();
    ParameterInterval {
        name: verdict.parameter.clone(),
        ends: [range.from, range.to].map(end),
        intervals: verdict
            .parts()
            .iter()
            .map(|(low, high)| (range.coordinate(*low), range.coordinate(*high)))
            .collect(),
        best: range.coordinate(verdict.best),
        truth: truth.map(|truth| range.coordinate(truth)),
        is_determined: verdict.identified,
        word: verdict.claim.brief().to_owned(),
    }
}
