//! The story of a gap: how many noise floors the simulation is away, and until when it may be trusted.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, key};
use super::section::{Section, figures, pictures};
use super::story::Story;
use super::value::*;
use realgap_core::error::Result;
use realgap_core::unit::{counted, decimals, number};

pub(super) fn gap(folder: &Path, report: &Value) -> Result<Story> {
    let is_floor_alone = report.get("sets").is_some();
    Ok(Story {
        kind: if is_floor_alone { "noise floor" } else { "gap" },
        name: report.named("study", "recordings"),
        answer: match is_floor_alone {
            true => floor_answer(report),
            false => answer(report),
        },
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
    let reality = match report.text("source") {
        "StandIn" => "the stand-in for reality",
        _ => "reality",
    };
    let Some(metric) = report.list("metrics").first() else {
        return "Not determined: nothing was compared.".to_owned();
    };
    // Repeats where there are some, else the run without noise.
    let either = |name: &str| {
        let mut both = ["repeats", "ideal"].map(|which| metric.at(&format!("{which}.{name}")));
        both.sort_by_key(|found| found.is_null());
        both[0]
    };
    let (ratio, gap) = (either("ratio"), either("gap"));
    let unit = metric.text("unit");
    let alike = match metric.float("alike.p_value") {
        None => String::new(),
        Some(p) if p < 0.05 => format!(
            "Simulated repeats are NOT drawn like {reality} (energy test, p = {}). ",
            number(p)
        ),
        Some(p) => format!(
            "Nothing tells simulated repeats from {reality} (energy test, p = {}, {}). ",
            number(p),
            counted(
                report.count("recordings").unwrap_or(0) as usize,
                "recording"
            )
        ),
    };
    let first = match ratio.float("value") {
        Some(value) => format!(
            "The simulation is {} noise floors away from {reality} (95 %: {}; at 1 as far on average as repeats are from each other, which does not say that they are alike): {} {} where repeats of the recorded run are {} apart.",
            number(value),
            ratio.span(["low", "high"], ""),
            metric.text("metric"),
            gap.measured("value", unit),
            metric.measured("floor.value", unit),
        ),
        None => format!(
            "How many noise floors the simulation is away is not determined: {} {} from {reality}, and there are no repeats of the recorded run.",
            metric.text("metric"),
            gap.measured("value", unit),
        ),
    };
    let confidence = report.at("confidence");
    let until = match (
        confidence.float("over_time"),
        confidence.float("below_half_s"),
    ) {
        (None, _) => String::new(),
        (Some(inside), until) => format!(
            " Over time {}{} of recorded runs are inside the region that should hold {}{}.",
            percent(Some(inside)),
            match confidence.floats("over_time_interval")[..] {
                [low, high] => format!(" ({} to {})", percent(Some(low)), percent(Some(high))),
                _ => String::new(),
            },
            confidence.percent("level"),
            until.map_or_else(
                || ", never fewer than half".to_owned(),
                |s| format!("; fewer than half are after {} s", decimals(s, 2))
            )
        ),
    };
    alike + &first + &until
}

fn floor_answer(report: &Value) -> String {
    let sets = report.list("sets");
    let first = sets.first().and_then(|set| set.list("metrics").first());
    let floors = sets.iter().filter_map(|set| {
        let metric = set.list("metrics").first()?;
        let floor = measured(metric.float("floor.value"), metric.text("unit"));
        Some(match sets.len() {
            1 => floor,
            _ => format!("{floor} ({})", set.text("set")),
        })
    });
    let said: Vec<String> = floors.take(6).collect();
    format!(
        "Repeats of one recorded run are {} apart in {}. No simulation can be told to be nearer than that.",
        said.join(", "),
        first.map_or("", |metric| metric.text("metric")),
    )
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
            "Dashed: what an honest region holds. Band: 95 % interval of the share, narrower with more recordings.",
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
