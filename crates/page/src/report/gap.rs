//! The story of a gap: how many noise floors the simulation is away, and until when it may be trusted.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, key};
use super::section::{Section, figures, pictures};
use super::story::Story;
use super::value::{
    at, count, first_text, float, floats, list, measured, noted, percent, span, text_of, titled,
};
use realgap_core::error::Result;
use realgap_core::unit::{decimals, number};

pub(super) fn gap(folder: &Path, report: &Value) -> Result<Story> {
    let is_floor_alone = report.get("sets").is_some();
    Ok(Story {
        kind: if is_floor_alone { "noise floor" } else { "gap" },
        name: first_text(report, &["study"])
            .unwrap_or("recordings")
            .to_owned(),
        answer: if is_floor_alone {
            floor_answer(report)
        } else {
            answer(report)
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
    let reality = match text_of(report, "source") {
        "StandIn" => "the stand-in for reality",
        _ => "reality",
    };
    let Some(metric) = list(report, "metrics").first() else {
        return "Not determined: nothing was compared.".to_owned();
    };
    let ratio = |which: &str| at(metric, &format!("{which}.ratio")).clone();
    let repeats = ratio("repeats");
    let ratio = if repeats.is_null() {
        ratio("ideal")
    } else {
        repeats
    };
    let unit = text_of(metric, "unit");
    let gap = at(
        metric,
        if at(metric, "repeats.gap").is_null() {
            "ideal.gap"
        } else {
            "repeats.gap"
        },
    );
    let first = match float(&ratio, "value") {
        Some(value) => format!(
            "The simulation is {} noise floors away from {reality} (95 %: {}; 1 means indistinguishable): {} {} where repeats of the recorded run are {} apart.",
            number(value),
            span(float(&ratio, "low"), float(&ratio, "high"), ""),
            text_of(metric, "metric"),
            measured(float(gap, "value"), unit),
            measured(float(at(metric, "floor"), "value"), unit),
        ),
        None => format!(
            "How many noise floors the simulation is away is not determined: {} {} from {reality}, and there are no repeats of the recorded run.",
            text_of(metric, "metric"),
            measured(float(gap, "value"), unit),
        ),
    };
    let confidence = at(report, "confidence");
    let until = match (
        float(confidence, "over_time"),
        float(confidence, "below_half_s"),
    ) {
        (None, _) => String::new(),
        (Some(inside), until) => format!(
            " Over time {} of recorded runs are inside the region that should hold {}{}.",
            percent(Some(inside)),
            percent(float(confidence, "level")),
            until.map_or_else(
                || ", never fewer than half".to_owned(),
                |s| format!("; fewer than half are after {} s", decimals(s, 2))
            )
        ),
    };
    first + &until
}

fn floor_answer(report: &Value) -> String {
    let sets = list(report, "sets");
    let first = sets.first().and_then(|set| list(set, "metrics").first());
    let floors = sets.iter().filter_map(|set| {
        let metric = list(set, "metrics").first()?;
        let floor = measured(float(at(metric, "floor"), "value"), text_of(metric, "unit"));
        Some(match sets.len() {
            1 => floor,
            _ => format!("{floor} ({})", text_of(set, "set")),
        })
    });
    let said: Vec<String> = floors.take(6).collect();
    format!(
        "Repeats of one recorded run are {} apart in {}. No simulation can be told to be nearer than that.",
        said.join(", "),
        first.map_or("", |metric| text_of(metric, "metric")),
    )
}

fn metrics(report: &Value) -> String {
    let rows = list(report, "metrics").iter().flat_map(|metric| {
        let unit = text_of(metric, "unit").to_owned();
        let interval = move |value: &Value, unit: &str| match float(value, "value") {
            None => "–".to_owned(),
            some => format!(
                "{} ({})",
                measured(some, unit),
                span(float(value, "low"), float(value, "high"), unit)
            ),
        };
        [("without noise", "ideal"), ("repeats, mean", "repeats")]
            .into_iter()
            .filter_map(move |(name, which)| {
                let found = metric.get(which).filter(|found| found.is_object())?;
                let p = float(at(metric, "alike"), "p_value").filter(|_| which == "repeats");
                Some(vec![
                    format!("{}: {name}", text_of(metric, "metric")),
                    interval(at(metric, "floor"), &unit),
                    interval(at(found, "gap"), &unit),
                    interval(at(found, "ratio"), ""),
                    p.map_or("–".to_owned(), number),
                ])
            })
    });
    noted(
        "metric | noise floor (95 %) | gap (95 %) | gap ratio (95 %) | drawn alike? p",
        rows,
        "A ratio of 1 means indistinguishable from reality. More recorded repeats narrow the noise floor, which the width of most of these intervals comes from.",
    )
}

fn sets(report: &Value) -> String {
    let rows = list(report, "sets").iter().flat_map(|set| {
        let recordings = count(set, "recordings").map_or("–".to_owned(), |n| n.to_string());
        list(set, "metrics").iter().map(move |metric| {
            let (floor, unit) = (at(metric, "floor"), text_of(metric, "unit"));
            vec![
                text_of(set, "set").to_owned(),
                recordings.clone(),
                text_of(metric, "metric").to_owned(),
                measured(float(floor, "value"), unit),
                span(float(floor, "low"), float(floor, "high"), unit),
            ]
        })
    });
    let note = "More repeats of the same run narrow the intervals.";
    noted("set | recordings | metric | noise floor | 95 %", rows, note)
}

fn over_time(report: &Value) -> String {
    let over = at(report, "over_time");
    let times = floats(over, "times_s");
    let line = |name: &str| -> Vec<[f64; 2]> {
        let values = times.iter().zip(floats(over, name));
        values.map(|(t, v)| [*t, v]).collect()
    };
    let mut all = Vec::new();
    if !times.is_empty() {
        let alt = "Distance to recorded runs over time, of the run without noise, of repeats, and of recorded runs among each other";
        let chart = Chart::over_time(alt, "distance [m]").from_zero();
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
    let confidence = at(report, "confidence");
    let times = floats(confidence, "times_s");
    if !times.is_empty() {
        let inside = list(confidence, "inside");
        let at_times = || times.iter().zip(inside);
        let of = |p: &Value, name: &str| float(p, name).unwrap_or(f64::NAN);
        let band = at_times().map(|(t, p)| [*t, of(p, "low"), of(p, "high")]);
        let line = at_times().map(|(t, p)| [*t, of(p, "share")]);
        let level = float(confidence, "level").unwrap_or(0.9);
        let ends = [times[0], times[times.len() - 1]];
        let alt = "Share of recorded runs inside the predicted region over time";
        let chart = Chart::over_time(alt, "share inside").from_zero();
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
    let found = at(report, "displacement");
    if !found.is_object() {
        return String::new();
    }
    let p = |name: &str| float(at(found, name), "p_value").map_or("–".to_owned(), number);
    titled(
        "recorded, mean | simulated, mean | drawn alike? p (Mann-Whitney) | p (Kolmogorov-Smirnov)",
        [vec![
            measured(float(found, "real_mean_m"), "m"),
            measured(float(found, "simulated_mean_m"), "m"),
            p("mann_whitney"),
            p("kolmogorov_smirnov"),
        ]],
    )
}
