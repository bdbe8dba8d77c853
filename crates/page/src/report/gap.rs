//! The story of a gap: how many noise floors the simulation is away, and until when it may be trusted.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, key};
use super::claim::sentences;
use super::section::{Section, figures, pictures};
use super::story::Story;
use super::value::*;
use realgap_core::error::Result;
use realgap_core::unit::number;

pub(super) fn gap(folder: &Path, report: &Value) -> Result<Story> {
    let is_floor_alone = report.get("sets").is_some();
    Ok(Story {
        kind: if is_floor_alone { "noise floor" } else { "gap" },
        name: report.named("study", "recordings"),
        answer: answer(report),
        sections: vec![
            Section::new("metrics", "How far, in noise floors", metrics(report)),
            Section::new("sets", "Sets of repeats", sets(report)),
            Section::new("over-time", "Over time", over_time(report)),
            Section::new("displacement", "How far it goes", displacement(report)),
            pictures(folder, "pictures", "More pictures", |stem| {
                !["rmse", "confidence"].contains(&stem)
            })?,
        ],
        said: vec![
            "metrics",
            "confidence",
            "over_time",
            "displacement",
            "noise",
            "sets",
        ],
        ..Story::default()
    })
}

fn answer(report: &Value) -> String {
    let about = ["likeness", "distance", "over_time", "floor"];
    match sentences(report, &about) {
        none if none.is_empty() => "Nothing was compared.".to_owned(),
        said => said,
    }
}

fn metrics(report: &Value) -> String {
    let rows = report.list("metrics").iter().flat_map(|metric| {
        let unit = metric.owned("unit");
        let interval = move |value: &Value, unit: &str| match value.float("value") {
            None => "–".to_owned(),
            some => format!(
                "{} ({})",
                measured(some, unit),
                value.span(["low", "high"], unit)
            ),
        };
        [("without noise", "ideal"), ("repeats, mean", "repeats")]
            .into_iter()
            .filter_map(move |(name, which)| {
                let found = metric.get(which).filter(|found| found.is_object())?;
                let p = metric.float("alike.p_value").filter(|_| which == "repeats");
                Some(vec![
                    format!("{}: {name}", metric.text("metric")),
                    p.map_or("–".to_owned(), number),
                    interval(found.at("ratio"), ""),
                    interval(found.at("gap"), &unit),
                    interval(metric.at("floor"), &unit),
                ])
            })
    });
    noted(
        "metric | drawn alike? p | gap ratio (95 %) | gap (95 %) | noise floor (95 %)",
        rows,
        "A ratio of 1 means as far from a recording, on average, as another recording is; whether both are drawn alike says p. More recorded repeats narrow the noise floor, which the width of most of these intervals comes from.",
    )
}

fn sets(report: &Value) -> String {
    let rows = report.list("sets").iter().flat_map(|set| {
        let recordings = set
            .count("recordings")
            .map_or("–".to_owned(), |n| n.to_string());
        set.list("metrics").iter().map(move |metric| {
            let (floor, unit) = (metric.at("floor"), metric.text("unit"));
            vec![
                set.owned("set"),
                recordings.clone(),
                metric.owned("metric"),
                floor.measured("value", unit),
                floor.span(["low", "high"], unit),
            ]
        })
    });
    let note = "More repeats of the same run narrow the intervals.";
    noted("set | recordings | metric | noise floor | 95 %", rows, note)
}

fn over_time(report: &Value) -> String {
    let over = report.at("over_time");
    let times = over.floats("times_s");
    let line = |name: &str| -> Vec<[f64; 2]> {
        let values = times.iter().zip(over.floats(name));
        values.map(|(t, v)| [*t, v]).collect()
    };
    let mut all = Vec::new();
    if !times.is_empty() {
        let alt = "Distance to recorded runs over time, of the run without noise, of repeats, and of recorded runs among each other";
        let chart = Chart::over_time(alt, "distance [m]").upwards();
        let chart = chart.line("real", line("real_mean_m"));
        let chart = chart.line("b4", line("simulated_mean_m"));
        let figure = chart.line("sim", line("ideal_m")).figure(
            "Distance to recorded runs",
            "Where the simulated lines leave that of recorded runs among each other, the simulation stops being one more repeat.",
        );
        let keys = key("sim", "without noise") + &key("b4", "repeats");
        let keys = keys + &key("real", "recorded among each other");
        all.push(format!("{figure}<div class=\"legend\">{keys}</div>"));
    }
    let confidence = report.at("confidence");
    let times = confidence.floats("times_s");
    if !times.is_empty() {
        let inside = confidence.list("inside");
        let at_times = || times.iter().zip(inside);
        let of = |p: &Value, name: &str| p.float(name).unwrap_or(f64::NAN);
        let band = at_times().map(|(t, p)| [*t, of(p, "low"), of(p, "high")]);
        let line = at_times().map(|(t, p)| [*t, of(p, "share")]);
        let level = confidence.float("level").unwrap_or(0.9);
        let ends = [times[0], times[times.len() - 1]];
        let alt = "Share of recorded runs inside the predicted region over time";
        let chart = Chart::over_time(alt, "share inside").upwards();
        let chart = chart.band(band.collect());
        let chart = chart.line("edge", ends.map(|t| [t, level]).to_vec());
        all.push(chart.line("sim", line.collect()).figure(
            "Recorded runs inside the predicted region",
            "Dashed: what the region promises. Band: 95 % interval of the share, narrower with more recordings.",
        ));
    }
    if all.is_empty() {
        return String::new();
    }
    let all: Vec<String> = all
        .into_iter()
        .map(|one| format!("<div>{one}</div>"))
        .collect();
    figures(&all)
}

fn displacement(report: &Value) -> String {
    let found = report.at("displacement");
    if !found.is_object() {
        return String::new();
    }
    let p = |name: &str| {
        found
            .at(name)
            .float("p_value")
            .map_or("–".to_owned(), number)
    };
    titled(
        "drawn alike? p (Mann-Whitney) | p (Kolmogorov-Smirnov) | recorded, mean | simulated, mean",
        [vec![
            p("mann_whitney"),
            p("kolmogorov_smirnov"),
            found.measured("real_mean_m", "m"),
            found.measured("simulated_mean_m", "m"),
        ]],
    )
}
