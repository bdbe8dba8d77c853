//! The best point's run beside the recorded ones: without scripts as it is; with scripts the run of the chosen point.

use super::page_data::{PageData, RecordedPath, recorded_of};
use crate::plot::{
    AxisSpec, Caption, Inline, InlineChart, LinePlot, PanelGrid, Series, SeriesKind, legend,
};
use crate::report::document::page::html;
use crate::report::document::section::{figure, figures};
use crate::results::study::chart::panel;
use crate::results::study::data::{PathXy, Points};
use realgap_core::unit::{Unit, number};

/// The path of the best point over the recorded ones, seen from above.
pub(super) fn from_above(
    points: &Points,
    paths: Option<&[PathXy]>,
    best: Option<usize>,
    data: Option<&PageData>,
    recordings: Option<usize>,
) -> String {
    let (Some(paths), Some(best)) = (paths, best) else {
        return String::new();
    };
    let recorded = recorded_of(data);
    let all = recordings.filter(|all| *all > recorded.len() && !recorded.is_empty());
    let count = all.map_or_else(String::new, |all| {
        format!(
            " Of {all} recordings, {} {} shown: of those that start as this run does.",
            recorded.len(),
            if recorded.len() == 1 { "is" } else { "are" }
        )
    });
    let point = &points.points[best];
    let names: Vec<&str> = points.names.iter().map(String::as_str).collect();
    let panels = PanelGrid {
        caption: Caption::default(),
        columns: 1,
        panels: vec![panel(
            &names,
            &point.values,
            point.score,
            &paths[best],
            true,
        )],
        reality_m: recorded.iter().map(|path| path.xy_m.clone()).collect(),
        reality_label: data.map_or_else(String::new, |data| data.reality.clone()),
        unit: Unit::One,
    };
    let chart = panels.chart(0);
    let alt = "Path of the chosen point over the recorded paths, seen from above";
    let values = point.values.iter().zip(&points.names);
    let title = values.map(|(value, name)| format!("{name} = {}", number(*value)));
    let title = title.collect::<Vec<_>>().join(", ");
    let recorded_key = if recorded.is_empty() {
        "<span>This folder keeps no recorded paths. To see them, run the command again or open trajectories.png.</span>"
    } else {
        ""
    };
    format!(
        "<figure><p id=\"chosen\" aria-live=\"polite\">{}: the best point.</p>{}{}<div class=\"legend\">{recorded_key}<span id=\"legend-best\" hidden><i class=\"key faint\"></i>simulation, best point</span></div><figcaption>The tracked module's path as the metric compares it: from the origin, with the net displacement to the right. Both axes have one scale.{count}</figcaption></figure>",
        html(&title),
        chart.inline(&Inline::new(alt).id("path")),
        legend(&chart),
    )
}

/// How far the best point's run and the recorded ones are at each time, and from each other.
pub(super) fn over_time(
    paths: Option<&[PathXy]>,
    best: Option<usize>,
    data: Option<&PageData>,
) -> String {
    let (Some(paths), Some(best)) = (paths, best) else {
        return String::new();
    };
    let (recorded, own) = (recorded_of(data), &paths[best]);
    let duration_s = data.map_or(1.0, |data| data.duration_s);
    let time = match data {
        Some(_) => AxisSpec::new("time", Unit::Second),
        None => AxisSpec::new("share of the run", Unit::One),
    };
    let chart = |alt: &str, id: &str, y_label: &str, series: Vec<Series>| {
        let y = (y_label, Unit::Metre);
        let plot = LinePlot::new(Caption::default(), time.clone(), y, series);
        let inline = Inline {
            follows_time: true,
            ..Inline::new(alt).id(id)
        };
        plot.inline(&inline)
    };
    let mut ahead: Vec<Series> = (recorded.iter())
        .map(|path| {
            Series::new("", SeriesKind::Line, along(&path.xy_m, path.duration_s)).recorded()
        })
        .collect();
    ahead.push(Series::new("", SeriesKind::Line, along(own, duration_s)));
    let alt = "How far along its direction the robot is, over time";
    let mut all = vec![figure(
        "Along the way",
        &chart(alt, "along", "x", ahead),
        "Parallel lines mean equal speeds. Where the slopes differ, friction or gait would have to change.",
    )];
    if !recorded.is_empty() {
        let lines = recorded.iter().map(|path| {
            let distances = distances(own, duration_s, path);
            Series::new("", SeriesKind::Line, distances)
        });
        let alt = "Distance to each recorded run at equal times";
        let label = "distance";
        all.push(figure(
            "Distance to each recorded run",
            &chart(alt, "error", label, lines.collect()),
            // One recorded run has no others beside it, so that no band is drawn.
            match recorded.len() {
                1 => "",
                _ => "The band shows how far each recorded run is from the mean of the others. Inside the band, the simulation is as near to a recorded run as the other recorded runs are.",
            },
        ));
    }
    figures(&all)
}

/// How far along x each place of a path is, over the time.
fn along(xy_m: &[[f64; 2]], duration_s: f64) -> Vec<(f64, f64)> {
    let steps = xy_m.len().saturating_sub(1).max(1) as f64;
    let places = xy_m.iter().enumerate();
    let points = places.map(|(k, place)| (duration_s * k as f64 / steps, place[0]));
    points.collect()
}

/// Distance of a run to a recorded one at equal times, as long as both last.
fn distances(own: &[[f64; 2]], duration_s: f64, path: &RecordedPath) -> Vec<(f64, f64)> {
    let steps = own.len().saturating_sub(1).max(1) as f64;
    let last = path.xy_m.len().saturating_sub(1);
    let place = |t_s: f64| {
        let at = (t_s / path.duration_s * last as f64).clamp(0.0, last as f64);
        let below = (at.floor() as usize).min(last.saturating_sub(1));
        let (a, b) = (path.xy_m.get(below)?, path.xy_m.get(below + 1)?);
        Some([0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * (at - below as f64)))
    };
    let own = own.iter().enumerate();
    let own = own.map(|(k, p)| (duration_s * k as f64 / steps, p));
    let both = own.take_while(|(t_s, _)| *t_s <= path.duration_s + 1e-9);
    let distances = both.filter_map(|(t_s, p)| {
        let other = place(t_s)?;
        Some((t_s, (p[0] - other[0]).hypot(p[1] - other[1])))
    });
    distances.collect()
}
