//! Pictures of a comparison of pictures: figures 5, 6, 8 and 11 of paper 002.

use std::path::{Path, PathBuf};

use crate::plot::{Caption, ColumnChart, ColumnSeries, ScoreScale, both, draw_columns};
use realgap_core::error::Result;
use realgap_vision::{ExtractorReport, PictureSource, ViewRow, VisionReport};

fn series(
    label: &str,
    report: &ExtractorReport,
    value: impl Fn(&ViewRow) -> Option<f64>,
) -> ColumnSeries {
    ColumnSeries {
        label: label.to_owned(),
        values: report.views.iter().map(value).collect(),
    }
}

/// Errors view by view; where an extractor has none, how much alike pictures are (1 − distance).
fn chart(report: &ExtractorReport, source: PictureSource) -> ColumnChart {
    let real = match source {
        PictureSource::StandIn => "real (stand-in)",
        _ => "real",
    };
    let alike = |distance: Option<f64>| distance.map(|d| 1.0 - d);
    let (label, mut columns) = match report.error_measure {
        Some(measure) => (
            match measure.unit {
                "" => measure.name.to_owned(),
                unit => format!("{} ({unit})", measure.name),
            },
            vec![
                series("simulated", report, |v| v.simulated_error),
                series(&format!("{real}, well lit"), report, |v| v.real_error),
                series(&format!("{real}, badly lit"), report, |v| v.badly_lit_error),
            ],
        ),
        None => (
            format!("correlation of {}", report.extractor),
            vec![
                series("simulated with itself", report, |v| {
                    v.simulated_real.map(|_| 1.0)
                }),
                series(&format!("simulated and {real}, well lit"), report, |v| {
                    alike(v.simulated_real)
                }),
                series(&format!("simulated and {real}, badly lit"), report, |v| {
                    alike(v.simulated_badly_lit)
                }),
                series(&format!("{real}, well lit and badly lit"), report, |v| {
                    alike(v.badly_lit_real)
                }),
            ],
        ),
    };
    columns.retain(|column| column.values.iter().any(Option::is_some));
    let mut subtitle = format!("as figure {} of paper 002", report.figure);
    if source == PictureSource::StandIn {
        subtitle += "; stand-ins in place of real pictures";
    }
    ColumnChart {
        caption: Caption::new(
            format!("{} in simulated and real pictures", report.extractor),
            subtitle,
        ),
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
