//! Pictures of a comparison of pictures: figures 5, 6, 8 and 11 of paper 002.

use std::path::{Path, PathBuf};

use crate::plot::{Caption, ColumnChart, ColumnSeries, ScoreScale, both, draw_columns};
use realgap_core::error::Result;
use realgap_vision::{ExtractorReport, PictureSource, ViewRow, VisionReport};

/// Errors view by view; where an extractor has none, how much alike pictures are (1 − distance).
fn chart(report: &ExtractorReport, source: PictureSource) -> ColumnChart {
    let real = match source {
        PictureSource::StandIn => "real (stand-in)",
        _ => "real",
    };
    let of = |label: String, value: fn(&ViewRow) -> Option<f64>| ColumnSeries {
        label,
        values: report.views.iter().map(value).collect(),
    };
    let (lit, unlit) = (format!("{real}, well lit"), format!("{real}, badly lit"));
    let (label, mut columns) = match report.error_measure {
        Some(measure) => (
            match measure.unit {
                "" => measure.name.to_owned(),
                unit => format!("{} ({unit})", measure.name),
            },
            vec![
                of("simulated".to_owned(), |v| v.simulated_error),
                of(lit, |v| v.real_error),
                of(unlit, |v| v.badly_lit_error),
            ],
        ),
        None => (
            format!("correlation of {}", report.extractor),
            vec![
                of("simulated with itself".to_owned(), |v| {
                    v.simulated_real.and(Some(1.0))
                }),
                of(format!("simulated and {lit}"), |v| {
                    Some(1.0 - v.simulated_real?)
                }),
                of(format!("simulated and {unlit}"), |v| {
                    Some(1.0 - v.simulated_badly_lit?)
                }),
                of(format!("{lit} and badly lit"), |v| {
                    Some(1.0 - v.badly_lit_real?)
                }),
            ],
        ),
    };
    columns.retain(|column| column.values.iter().any(Option::is_some));
    let mut subtitle = format!("as figure {} of paper 002", report.figure);
    if source == PictureSource::StandIn {
        subtitle += "; stand-ins in place of real pictures";
    }
    let title = format!("{} in simulated and real pictures", report.extractor);
    ColumnChart {
        caption: Caption::new(title, subtitle),
        label,
        groups: report.views.iter().map(|v| v.view.clone()).collect(),
        series: columns,
        // A template that is lost is hundreds of pixels away, one that is found less than one.
        scale: match report.error_measure {
            Some(measure) if measure.unit == "px" => ScoreScale::Auto,
            _ => ScoreScale::Linear,
        },
    }
}

/// Draws one picture an extractor into an existing folder, `NAME.png` and the same as `NAME.svg`; says which `.png` there are.
///
/// # Errors
/// A folder that cannot be written.
pub fn draw_vision(report: &VisionReport, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>> {
    let mut drawn = Vec::new();
    for extractor in &report.extractors {
        let chart = chart(extractor, report.real);
        if chart.series.is_empty() {
            continue;
        }
        let stem = extractor.extractor;
        both(folder.as_ref(), stem, |path| draw_columns(&chart, path))?;
        drawn.push(folder.as_ref().join(format!("{stem}.png")));
    }
    Ok(drawn)
}
