//! The story of a gap: how many noise floors the simulation is away, and until when it may be trusted.

use std::path::Path;

use serde::Deserialize;

use crate::report::document::section::{Section, figures, pictures};
use crate::report::document::value::*;
use crate::report::folder::chart::{Chart, key, over};
use crate::report::folder::claim::sentences;
use crate::report::folder::story::Story;
use realgap_core::error::Result;
use realgap_core::statistics::EnergyTest;
use realgap_core::unit::number;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::gap::{Confidence, Estimate, Fitness, GapAndRatio, OverTime};

/// What a page shows of a gap, or of noise floors alone.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Gap {
    study: Option<String>,
    pub(in crate::report) claims: Vec<Claim>,
    pub(in crate::report) metrics: Vec<OfMetric>,
    sets: Option<Vec<Set>>,
    over_time: Option<OverTime>,
    pub(in crate::report) confidence: Option<Confidence>,
    displacement: Option<Fitness>,
}

/// What a page shows of one metric.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct OfMetric {
    pub(in crate::report) metric: String,
    unit: String,
    floor: Option<Estimate>,
    ideal: Option<GapAndRatio>,
    pub(in crate::report) repeats: Option<GapAndRatio>,
    pub(in crate::report) alike: Option<EnergyTest>,
}

/// What a page shows of a set of repeats.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Set {
    set: String,
    recordings: Option<usize>,
    metrics: Vec<OfMetric>,
}

pub(in crate::report) fn gap(folder: &Path, report: &Gap) -> Result<Story> {
    let is_floor_alone = report.sets.is_some();
    let about = [
        About::Likeness,
        About::Distance,
        About::OverTime,
        About::Floor,
    ];
    let answer = match sentences(&report.claims, &about) {
        said if said.is_empty() => "Nothing was compared.".to_owned(),
        said => said,
    };
    Ok(Story {
        kind: if is_floor_alone { "noise floor" } else { "gap" },
        name: report.study.clone().unwrap_or("recordings".to_owned()),
        answer,
        sections: vec![
            Section::new("metrics", "How far, in noise floors", metrics(report)),
            Section::new("sets", "Sets of repeats", sets(report)),
            Section::new("over-time", "Over time", over_time(report)),
            Section::new("displacement", "How far it goes", displacement(report)),
            pictures(folder, "pictures", "More pictures", |stem| {
                !["rmse", "confidence"].contains(&stem)
            })?,
        ],
        said: "metrics confidence over_time displacement noise sets",
        ..Story::default()
    })
}

fn metrics(report: &Gap) -> String {
    let rows = report.metrics.iter().flat_map(|metric| {
        let interval = |found: Option<Estimate>, unit: &str| {
            let said = |e: Estimate| {
                format!(
                    "{} ({})",
                    measured(e.value, unit),
                    span(e.low, e.high, unit)
                )
            };
            shown(found.map(said))
        };
        let p = metric.alike.map(|alike| alike.p_value);
        let kinds = [
            ("without noise", metric.ideal, None),
            ("repeats, mean", metric.repeats, p),
        ];
        kinds.into_iter().filter_map(move |(name, found, p)| {
            let found = found?;
            Some(vec![
                format!("{}: {name}", metric.metric),
                measured(p, ""),
                interval(found.ratio, ""),
                interval(Some(found.gap), &metric.unit),
                interval(metric.floor, &metric.unit),
            ])
        })
    });
    noted(
        "metric | drawn alike? p | gap ratio (95 %) | gap (95 %) | noise floor (95 %)",
        rows,
        "A ratio of 1 means as far from a recording, on average, as another recording is; whether both are drawn alike says p. More recorded repeats narrow the noise floor, which the width of most of these intervals comes from.",
    )
}

fn sets(report: &Gap) -> String {
    let rows = report.sets.iter().flatten().flat_map(|set| {
        set.metrics.iter().map(move |of| {
            let floor = of.floor;
            let [low, high] = [floor.and_then(|f| f.low), floor.and_then(|f| f.high)];
            vec![
                set.set.clone(),
                shown(set.recordings),
                of.metric.clone(),
                measured(floor.map(|floor| floor.value), &of.unit),
                span(low, high, &of.unit),
            ]
        })
    });
    let note = "More repeats of the same run narrow the intervals.";
    noted("set | recordings | metric | noise floor | 95 %", rows, note)
}

fn over_time(report: &Gap) -> String {
    let mut all = Vec::new();
    let found = report.over_time.as_ref();
    if let Some(found) = found.filter(|found| !found.times_s.is_empty()) {
        let line = |values: &Option<Vec<f64>>| over(&found.times_s, values.iter().flatten());
        let alt = "Distance to recorded runs over time, of the run without noise, of repeats, and of recorded runs among each other";
        let chart = Chart::over_time(alt, "distance [m]").upwards();
        let chart = chart.line("real", line(&found.real_mean_m));
        let chart = chart.line("b4", line(&found.simulated_mean_m));
        let figure = chart.line("sim", line(&found.ideal_m)).figure(
            "Distance to recorded runs",
            "Where the simulated lines leave that of recorded runs among each other, the simulation stops being one more repeat.",
        );
        let keys = key("sim", "without noise") + &key("b4", "repeats");
        let keys = keys + &key("real", "recorded among each other");
        all.push(format!(
            "<div>{figure}<div class=\"legend\">{keys}</div></div>"
        ));
    }
    if let Some(found) = &report.confidence
        && let [first, .., last] = found.times_s.as_slice()
    {
        let at_times = || found.times_s.iter().zip(&found.inside);
        let band = at_times().map(|(t, p)| [*t, p.low, p.high]);
        let line = at_times().map(|(t, p)| [*t, p.share]);
        let alt = "Share of recorded runs inside the predicted region over time";
        let chart = Chart::over_time(alt, "share inside").upwards();
        let chart = chart.band(band.collect());
        let level = [first, last].map(|t| [*t, found.level]);
        let chart = chart.line("edge", level.to_vec());
        let figure = chart.line("sim", line.collect()).figure(
            "Recorded runs inside the predicted region",
            "Dashed: what the region promises. Band: 95 % interval of the share, narrower with more recordings.",
        );
        all.push(format!("<div>{figure}</div>"));
    }
    match all.is_empty() {
        true => String::new(),
        false => figures(&all),
    }
}

fn displacement(report: &Gap) -> String {
    let Some(found) = &report.displacement else {
        return String::new();
    };
    titled(
        "drawn alike? p (Mann-Whitney) | p (Kolmogorov-Smirnov) | recorded, mean | simulated, mean",
        [vec![
            number(found.mann_whitney.p_value),
            number(found.kolmogorov_smirnov.p_value),
            measured(found.real_mean_m, "m"),
            measured(found.simulated_mean_m, "m"),
        ]],
    )
}
