//! Pictures of a gap over time: `confidence.png`, `rmse.png`, and the same as `.svg`.

use std::path::Path;

use super::draft::publish;
use super::ensemble::{make, write_report};
use super::kind::Kind;
use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted};
use realgap_lab::prediction::gap::{FloorReport, StudyGap};

/// Writes what a gap report holds: `gap.json`, and pictures of what it has over time; those of an earlier one are removed.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_gap(folder: &Path, gap: &StudyGap) -> Result<()> {
    let real_label = gap.source.reality_label();
    make(folder)?;
    publish(folder, Kind::Gap, |draft| {
        write_report(draft, "gap.json", gap)?;
        if let Some(plot) = confidence(gap, real_label) {
            draw(draft, "confidence", &plot)?;
        }
        if let Some(plot) = rmse(gap, real_label) {
            draw(draft, "rmse", &plot)?;
        }
        Ok(())
    })
}

/// Writes the noise floor of recordings alone, `gap.json`, in place of an earlier gap.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_floor(folder: &Path, floor: &FloorReport) -> Result<()> {
    make(folder)?;
    publish(folder, Kind::Gap, |draft| {
        write_report(draft, "gap.json", floor)
    })
}

fn draw(folder: &Path, stem: &str, plot: &LinePlot) -> Result<()> {
    for extension in ["png", "svg"] {
        draw_lines(plot, folder.join(format!("{stem}.{extension}")))?;
    }
    Ok(())
}

fn subtitle(gap: &StudyGap, real_label: &str) -> String {
    let repeats = match gap.repeats {
        0 => "no ensemble".to_owned(),
        repeats => format!("{repeats} repeats under noise, seed {}", gap.seed),
    };
    format!(
        "{}, {} ({real_label}); {repeats}",
        gap.morphology,
        counted(gap.recordings, "recording")
    )
}

fn confidence(gap: &StudyGap, real_label: &str) -> Option<LinePlot> {
    let confidence = gap.confidence.as_ref()?;
    let [low, share, high] = confidence.curves();
    let over = |values: Vec<f64>| -> Vec<(f64, f64)> {
        confidence.times_s.iter().copied().zip(values).collect()
    };
    let level = |value: f64| over(vec![value; confidence.times_s.len()]);
    let dropped = confidence.drop_in_words();
    Some(LinePlot {
        caption: Caption::new(
            format!("{}: simulation confidence, {dropped}", gap.study),
            subtitle(gap, real_label),
        ),
        x: AxisSpec::new("time", Unit::Second),
        y_label: "share of real runs inside".to_owned(),
        y_unit: Unit::One,
        scale: ScoreScale::Linear,
        y_range: Some((0.0, 1.0)),
        series: vec![
            Series {
                label: "95 % interval (Wilson)".to_owned(),
                points: over(low),
                kind: SeriesKind::Band(high),
                colour: 0,
            },
            Series {
                label: format!(
                    "what the region promises ({:.0} %), and 50 %",
                    100.0 * confidence.level
                ),
                points: level(confidence.level),
                kind: SeriesKind::Level,
                colour: 0,
            },
            Series {
                label: String::new(),
                points: level(0.5),
                kind: SeriesKind::Level,
                colour: 0,
            },
            Series {
                label: "C(t)".to_owned(),
                points: over(share),
                kind: SeriesKind::Line,
                colour: 0,
            },
        ],
    })
}

fn rmse(gap: &StudyGap, real_label: &str) -> Option<LinePlot> {
    let over = &gap.over_time;
    let series: Vec<Series> = [
        ("run without noise", &over.ideal_m),
        ("mean of the repeats under noise", &over.simulated_mean_m),
        ("mean of the other recordings", &over.real_mean_m),
    ]
    .into_iter()
    .enumerate()
    .filter_map(|(colour, (label, values))| {
        let values = values.as_ref()?;
        Some(Series {
            label: label.to_owned(),
            points: over
                .times_s
                .iter()
                .copied()
                .zip(values.iter().copied())
                .collect(),
            kind: SeriesKind::Line,
            colour,
        })
    })
    .collect();
    (!series.is_empty()).then(|| LinePlot {
        caption: Caption::new(
            format!("{}: error over time", gap.study),
            subtitle(gap, real_label),
        ),
        x: AxisSpec::new("time", Unit::Second),
        y_label: "RMS distance from the recordings".to_owned(),
        y_unit: Unit::Metre,
        scale: ScoreScale::Linear,
        y_range: None,
        series,
    })
}
