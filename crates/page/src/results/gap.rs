//! Pictures of a gap over time: `confidence.png`, `rmse.png`, and the same as `.svg`.

use std::path::Path;

use super::draft::publish;
use super::ensemble::{make, write_report};
use super::kind::{Kind, file};
use crate::plot::{AxisSpec, Caption, LinePlot, Series, SeriesKind, both, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted};
use realgap_lab::prediction::gap::{FloorReport, StudyGap};

/// Writes what a gap report holds: `gap.json`, and pictures of what it has over time; those of an earlier one are removed.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_gap(folder: &Path, gap: &StudyGap) -> Result<()> {
    make(folder)?;
    publish(folder, Kind::Gap, |draft| {
        write_report(draft, file::GAP, gap)?;
        let drawn = [("confidence", confidence(gap)), ("rmse", rmse(gap))];
        for (stem, plot) in drawn {
            if let Some(plot) = plot {
                both(draft, stem, |path| draw_lines(&plot, path))?;
            }
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
        write_report(draft, file::GAP, floor)
    })
}

fn subtitle(gap: &StudyGap) -> String {
    let repeats = match gap.repeats {
        0 => "no ensemble".to_owned(),
        repeats => format!("{repeats} repeats under noise, seed {}", gap.seed),
    };
    format!(
        "{}, {} ({}); {repeats}",
        gap.morphology,
        counted(gap.recordings, "recording"),
        gap.source.reality_label()
    )
}

fn confidence(gap: &StudyGap) -> Option<LinePlot> {
    let confidence = gap.confidence.as_ref()?;
    let [low, share, high] = confidence.curves();
    let over = |values: Vec<f64>| -> Vec<(f64, f64)> {
        confidence.times_s.iter().copied().zip(values).collect()
    };
    let level = |value: f64| over(vec![value; confidence.times_s.len()]);
    let promise = 100.0 * confidence.level;
    let promise = format!("what the region promises ({promise:.0} %), and 50 %");
    let dropped = confidence.drop_in_words();
    let title = format!("{}: simulation confidence, {dropped}", gap.study);
    let series = vec![
        Series::new("95 % interval (Wilson)", SeriesKind::Band(high), over(low)),
        Series::new(promise, SeriesKind::Level, level(confidence.level)),
        Series::new("", SeriesKind::Level, level(0.5)),
        Series::new("C(t)", SeriesKind::Line, over(share)),
    ];
    Some(LinePlot {
        y_range: Some((0.0, 1.0)),
        ..LinePlot::new(
            Caption::new(title, subtitle(gap)),
            AxisSpec::new("time", Unit::Second),
            ("share of real runs inside", Unit::One),
            series,
        )
    })
}

fn rmse(gap: &StudyGap) -> Option<LinePlot> {
    let over = &gap.over_time;
    let all = [
        ("run without noise", &over.ideal_m),
        ("mean of the repeats under noise", &over.simulated_mean_m),
        ("mean of the other recordings", &over.real_mean_m),
    ];
    let all = all.into_iter().enumerate();
    let series = all.filter_map(|(colour, (label, values))| {
        let points = over.times_s.iter().copied().zip(values.clone()?).collect();
        Some(Series::new(label, SeriesKind::Line, points).colour(colour))
    });
    let series: Vec<Series> = series.collect();
    (!series.is_empty()).then(|| {
        LinePlot::new(
            Caption::new(format!("{}: error over time", gap.study), subtitle(gap)),
            AxisSpec::new("time", Unit::Second),
            ("RMS distance from the recordings", Unit::Metre),
            series,
        )
    })
}
