//! The best point's run beside the recorded ones: as it is without scripts; with them, that of the chosen point.

use crate::report::document::page::html;
use crate::report::document::section::{figure, figures};
use crate::report::folder::chart::{Chart, key};
use crate::report::folder::page_data::{Kept, KeptPath, recorded_of};
use crate::report::folder::points::{Paths, Points};
use realgap_core::unit::{counted, number};

/// The best point's path over the recorded ones: as it is without scripts; with them, that of the chosen point.
pub(in crate::report) fn from_above(
    points: &Points,
    paths: Option<&Paths>,
    best: Option<usize>,
    kept: Option<&Kept>,
) -> String {
    let (Some(paths), Some(best)) = (paths, best) else {
        return String::new();
    };
    let recorded = recorded_of(kept);
    let map = Chart::map("Path of the chosen point over the recorded paths, seen from above")
        .lines("real", recorded.iter().map(|path| path.xy_m.clone()))
        .line("sim", paths.xy_m[best].clone());
    let values = points.points[best].values.iter().zip(&points.names);
    let title = values.map(|(value, name)| format!("{name} = {}", number(*value)));
    let title = title.collect::<Vec<_>>().join(", ");
    let legend = if recorded.is_empty() {
        "<span>This folder keeps no recorded paths: run the command again, or see its trajectories.png.</span>".to_owned()
    } else {
        let runs = counted(recorded.len(), "run");
        let reality = kept.map_or("recorded", |kept| kept.reality.as_str());
        key("real", &format!("{reality} ({runs})"))
    };
    format!(
        "<figure><p id=\"chosen\" aria-live=\"polite\">{}: the best point.</p>{}<div class=\"legend\"><span><i class=\"key sim\"></i>simulated</span>{legend}<span id=\"legend-best\" hidden><i class=\"key faint\"></i>simulated, best point</span></div><figcaption>The tracked module's path as it is compared: from the origin, net displacement to the right; one scale for both axes.</figcaption></figure>",
        html(&title),
        named(&map, "path"),
    )
}

/// How far the best point's run and the recorded ones are at each time, and from each other.
pub(in crate::report) fn over_time(
    paths: Option<&Paths>,
    best: Option<usize>,
    kept: Option<&Kept>,
) -> String {
    let (Some(paths), Some(best)) = (paths, best) else {
        return String::new();
    };
    let (recorded, own) = (recorded_of(kept), &paths.xy_m[best]);
    let duration_s = kept.map_or(1.0, |kept| kept.duration_s);
    let along = |xy_m: &[[f64; 2]], duration_s: f64| -> Vec<[f64; 2]> {
        let steps = xy_m.len().saturating_sub(1).max(1) as f64;
        let places = xy_m.iter().enumerate();
        let points = places.map(|(k, place)| [duration_s * k as f64 / steps, place[0]]);
        points.collect()
    };
    let over_time = |alt: &str, y_label: &str| {
        let mut chart = Chart::over_time(alt, y_label);
        if kept.is_none() {
            chart.x_label = "share of the run".to_owned();
        }
        chart
    };
    let alt = "How far along its direction the robot is, over time";
    let real = recorded.iter();
    let real = real.map(|path| along(&path.xy_m, path.duration_s));
    let chart = over_time(alt, "x [m]").lines("real", real);
    let chart = chart.line("sim", along(own, duration_s));
    let mut all = vec![figure(
        "Along the way",
        &named(&chart, "along"),
        "Parallel lines go equally fast; a different slope is what friction or gait would have to change.",
    )];
    if !recorded.is_empty() {
        let alt = "Distance to each recorded run at equal times";
        let lines = recorded.iter().map(|path| apart(own, duration_s, path));
        let error = over_time(alt, "distance to recorded [m]").upwards();
        let error = error.lines("sim", lines);
        all.push(figure(
            "Distance to each recorded run",
            &named(&error, "error"),
            "The band is how far recorded runs are from the mean of the others: inside of it, nothing more can be asked of the simulation.",
        ));
    }
    figures(&all)
}

/// A chart that the scripts draw anew.
fn named(chart: &Chart, id: &str) -> String {
    let named = format!("<svg id=\"{id}\" ");
    chart.svg().replacen("<svg ", &named, 1)
}

/// Distance of a run to a recorded one at equal times, as long as both last.
fn apart(own: &[[f64; 2]], duration_s: f64, path: &KeptPath) -> Vec<[f64; 2]> {
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
    let apart = both.filter_map(|(t_s, p)| {
        let other = place(t_s)?;
        Some([t_s, (p[0] - other[0]).hypot(p[1] - other[1])])
    });
    apart.collect()
}
