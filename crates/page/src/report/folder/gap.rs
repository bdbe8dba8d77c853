//! The page of a gap: how many noise floors the simulation is away from the recordings, and for how long it may be trusted.

use serde::Deserialize;

use super::claim::sentences;
use super::content::PageContent;
use crate::plot::{Inline, LinePlot};
use crate::report::document::picture::Pictures;
use crate::report::document::section::{Section, chart_figure, figures};
use crate::report::document::value::*;
use crate::results::{confidence_chart, over_time_chart};
use realgap_core::statistics::EnergyTest;
use realgap_core::unit::number;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::gap::{Confidence, Estimate, Fitness, GapAndRatio, OverTime};

/// What a page shows of a gap, or of noise floors alone.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct GapSummary {
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

pub(super) fn content(report: &GapSummary, pictures: &Pictures) -> PageContent {
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
    PageContent {
        kind: if is_floor_alone { "noise floor" } else { "gap" },
        name: report.study.clone().unwrap_or("recordings".to_owned()),
        claims: report.claims.clone(),
        answer,
        sections: vec![
            Section::new("over-time", "Over time", over_time(report)),
            Section::new("metrics", "How far, in noise floors", metrics(report)),
            Section::new("sets", "Sets of repeats", sets(report)),
            Section::new("displacement", "How far it goes", displacement(report)),
            pictures.section("pictures", "More pictures", |stem| {
                !["rmse", "confidence"].contains(&stem)
            }),
        ],
        shown_fields: "metrics confidence over_time displacement noise sets",
        ..PageContent::default()
    }
}

fn metrics(report: &GapSummary) -> String {
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
        "metric | same distribution? p | gap ratio (95 %) | gap (95 %) | noise floor (95 %)",
        rows,
        "A ratio of 1 means that the simulation is, on average, as far from a recording as another recording is. The p value tests whether simulations and recordings come from one distribution. More recorded repeats narrow the noise floor, from which most of the width of these intervals comes.",
    )
}

fn sets(report: &GapSummary) -> String {
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

fn over_time(report: &GapSummary) -> String {
    let mut all = Vec::new();
    let found = report.over_time.as_ref();
    let found = found.filter(|found| !found.times_s.is_empty());
    // The titles above say what the axes show, so that their names may be short.
    let named = |plot: LinePlot, name: &str| LinePlot {
        y_label: name.to_owned(),
        ..plot
    };
    if let Some(plot) = found.and_then(over_time_chart) {
        let alt = "Distance to recorded runs over time, of the run without noise, of repeats, and of recorded runs among each other";
        all.push(chart_figure(
            "Distance to recorded runs",
            &named(plot, "RMS distance"),
            &Inline::new(alt),
            "While a simulated line is no higher than the line of the other recordings, the simulation is as near to a recorded run as a further recording would be.",
        ));
    }
    if let Some(found) = &report.confidence
        && found.times_s.len() > 1
    {
        let alt = "Share of recorded runs inside the predicted region over time";
        all.push(chart_figure(
            "Recorded runs inside the predicted region",
            &named(confidence_chart(found), "share inside"),
            &Inline::new(alt),
            "The interval of the share becomes narrower with more recordings.",
        ));
    }
    match all.is_empty() {
        true => String::new(),
        false => figures(&all),
    }
}

fn displacement(report: &GapSummary) -> String {
    let Some(found) = &report.displacement else {
        return String::new();
    };
    titled(
        "same distribution? p (Mann-Whitney) | p (Kolmogorov-Smirnov) | recorded, mean | simulated, mean",
        [vec![
            number(found.mann_whitney.p_value),
            number(found.kolmogorov_smirnov.p_value),
            measured(found.real_mean_m, "m"),
            measured(found.simulated_mean_m, "m"),
        ]],
    )
}
