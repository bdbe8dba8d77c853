//! What a gap leaves in a folder: `gap.json`, and its charts over time.

use std::path::Path;

use super::draft::publish;
use super::ensemble::{make, write_report};
use super::kind::{Kind, file};
use crate::plot::{AxisSpec, Caption, LinePlot, Series, SeriesKind};
use crate::report::ResultsPage;
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted};
use realgap_lab::prediction::gap::{Confidence, FloorReport, OverTime, StudyGap};

/// Writes what a gap report holds: `gap.json`, and pictures of what it has over time; those of an earlier one are removed.
/// Returned is what the page of the folder shows.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_gap(folder: &Path, gap: &StudyGap) -> Result<ResultsPage> {
    make(folder)?;
    publish(folder, Kind::Gap, |draft| {
        write_report(draft.folder(), file::GAP, gap)?;
        if let Some(confidence) = &gap.confidence {
            let dropped = confidence.drop_in_words();
            let title = format!("{}: simulation confidence, {dropped}", gap.study);
            let caption = Caption::new(title, subtitle(gap));
            let plot = confidence_chart(confidence);
            draft.draw("confidence", &LinePlot { caption, ..plot })?;
        }
        if let Some(plot) = over_time_chart(&gap.over_time) {
            let title = format!("{}: error over time", gap.study);
            let caption = Caption::new(title, subtitle(gap));
            draft.draw("rmse", &LinePlot { caption, ..plot })?;
        }
        ResultsPage::of_gap(gap, draft.take_pictures())
    })
}

/// Writes the noise floor of recordings alone, `gap.json`, in place of an earlier gap. Returned is what the page of the folder
/// shows.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_floor(folder: &Path, floor: &FloorReport) -> Result<ResultsPage> {
    make(folder)?;
    publish(folder, Kind::Gap, |draft| {
        write_report(draft.folder(), file::GAP, floor)?;
        ResultsPage::of_gap(floor, draft.take_pictures())
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

/// The share of recordings inside the predicted region over time.
pub(crate) fn confidence_chart(confidence: &Confidence) -> LinePlot {
    let [low, share, high] = confidence.curves();
    let over = |values: Vec<f64>| -> Vec<(f64, f64)> {
        confidence.times_s.iter().copied().zip(values).collect()
    };
    let level = |value: f64| over(vec![value; confidence.times_s.len()]);
    let promise = 100.0 * confidence.level;
    let promise = format!("what the region promises ({promise:.0} %), and 50 %");
    let series = vec![
        Series::new("95 % interval (Wilson)", SeriesKind::Band(high), over(low)),
        Series::new(promise, SeriesKind::Level, level(confidence.level)),
        Series::new("", SeriesKind::Level, level(0.5)),
        Series::new("C(t)", SeriesKind::Line, over(share)),
    ];
    LinePlot {
        y_range: Some((0.0, 1.0)),
        ..LinePlot::new(
            Caption::default(),
            AxisSpec::new("time", Unit::Second),
            ("share of real runs inside", Unit::One),
            series,
        )
    }
}

/// The distance from the recordings over time; `None` where nothing was compared.
pub(crate) fn over_time_chart(over: &OverTime) -> Option<LinePlot> {
    let all = [
        ("run without noise", &over.ideal_m),
        ("mean of the repeats under noise", &over.simulated_mean_m),
        ("mean of the other recordings", &over.real_mean_m),
    ];
    let all = all.into_iter().enumerate();
    let series = all.filter_map(|(colour, (label, values))| {
        let points = over.times_s.iter().copied().zip(values.clone()?).collect();
        let series = Series::new(label, SeriesKind::Line, points).colour(colour);
        Some(match colour {
            2 => series.recorded(),
            _ => series,
        })
    });
    let series: Vec<Series> = series.collect();
    (!series.is_empty()).then(|| {
        LinePlot::new(
            Caption::default(),
            AxisSpec::new("time", Unit::Second),
            ("RMS distance from the recordings", Unit::Metre),
            series,
        )
    })
}
