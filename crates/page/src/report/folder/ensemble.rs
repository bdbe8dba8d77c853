//! The page of an ensemble: how far the robot goes, which behaviours it has and how likely they are, and what recordings say.

use serde::Deserialize;

use super::claim::{sentences, word};
use super::content::PageContent;
use crate::plot::{Inline, InlineChart, LinePlot, Series, SeriesKind, legend};
use crate::report::document::picture::Pictures;
use crate::report::document::section::{Section, figure, figures, within};
use crate::report::document::value::*;
use crate::results::ensemble_plot;
use realgap_core::statistics::Proportion;
use realgap_core::unit::number;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::ensemble::{Behaviours, Envelope, Quantiles, Reality};
use realgap_simulation::{Distribution, Noise};

/// Charts of more starts than this would hide the first.
const STARTS: usize = 6;

/// What a page shows of the repeats of a study.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct EnsembleSummary {
    study: Option<String>,
    pub(in crate::report) claims: Vec<Claim>,
    pub(in crate::report) reality: Option<Reality>,
    cases: Vec<Case>,
}

/// What a page shows of one start.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Case {
    pub(in crate::report) case: String,
    pub(in crate::report) summary: ForecastSummary,
}

/// What a page shows of a forecast.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct ForecastSummary {
    displacement_m: Option<Quantiles>,
    path_length_m: Option<Quantiles>,
    speed_m_s: Option<Quantiles>,
    turned_rad: Option<Quantiles>,
    noise_free_displacement_m: Option<f64>,
    diverged: Option<Proportion>,
    pub(in crate::report) behaviours: Behaviours,
    envelope: Option<Envelope>,
    pub(in crate::report) noise: Noise,
}

pub(super) fn content(report: &EnsembleSummary, pictures: &Pictures) -> PageContent {
    let cases = report.cases.as_slice();
    let mut motion = String::new();
    for case in cases.iter().take(STARTS) {
        let name = if cases.len() > 1 { &case.case } else { "" };
        motion += &charts(name, &case.summary);
    }
    if cases.len() > STARTS {
        let all = cases.len();
        let note = format!("{STARTS} of {all} starts; ensemble.json holds all.");
        motion += &format!("<p class=\"note\">{note}</p>");
    }
    let does = behaviour_table(cases);
    let noise = cases.first().map(|case| noise(&case.summary.noise));
    let recorded = report.reality.as_ref().map(|real| recorded(report, real));
    PageContent {
        kind: "ensemble",
        name: report.study.clone().unwrap_or("ensemble".to_owned()),
        claims: report.claims.clone(),
        answer: sentences(&report.claims, &[About::Ensemble]),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", motion),
            Section::new("distance", "How far", distances(cases)),
            Section::new("reality", "What recordings say", recorded),
            Section::new("noise", "How repeats differ", noise),
            pictures.section("pictures", "All repeats", |_| true),
        ],
        shown_fields: "reality cases",
        ..PageContent::default()
    }
}

/// The behaviours of every start. The distance that separates behaviours is that of the first start.
pub(in crate::report) fn behaviour_table(cases: &[Case]) -> String {
    let Some(Case { summary: first, .. }) = cases.first() else {
        return String::new();
    };
    let many = cases.len() > 1;
    let rows = cases.iter().take(40).flat_map(|case| {
        let list = case.summary.behaviours.list.iter();
        list.map(move |behaviour| {
            let mut row = vec![
                behaviour.name.clone(),
                odds(behaviour.probability),
                measured(behaviour.mean_displacement_m, "m"),
                shown(behaviour.representative),
            ];
            if many {
                row.insert(0, case.case.clone());
            }
            row
        })
    });
    let head = "behaviour | probability (95 %) | net displacement | typical repeat";
    let head = if many { "start | " } else { "" }.to_owned() + head;
    let lost = match first.diverged.filter(|diverged| diverged.count > 0) {
        Some(diverged) => format!("<p>{} of the repeats diverged.</p>", odds(diverged)),
        None => String::new(),
    };
    format!(
        "{}{lost}<p class=\"note\">Repeats belong to one behaviour where their paths are nearer than {} to each other. More repeats narrow the intervals of the probabilities; the probabilities themselves change only with other noise or another model.</p>",
        titled(&head, rows),
        measured(first.behaviours.cut_m, "m"),
    )
}

/// Points around the edge of a region.
const OUTLINE: usize = 64;

/// Typical paths of the behaviours with the regions of their ends, and the regions over time.
pub(in crate::report) fn charts(name: &str, summary: &ForecastSummary) -> String {
    let envelope = summary.envelope.as_ref();
    let plot = ensemble_plot(&summary.behaviours, envelope);
    let [mut paths, along, across] = plot.charts();
    let ends = envelope.and_then(|envelope| envelope.regions.last());
    let ends = ends.into_iter().flat_map(|end| {
        [0, 2].map(|level| {
            let mut outline = end.outline_m(level, OUTLINE);
            outline.extend(outline.first().copied());
            let points = outline.into_iter().map(|[x, y]| (x, y)).collect();
            Series::new("", SeriesKind::Level, points)
        })
    });
    paths.series.splice(0..0, ends.collect::<Vec<_>>());
    let chart = |plot: &LinePlot, alt: &str| plot.inline(&Inline::new(alt));
    let alt = "A typical path of each behaviour, and where half and nine of ten repeats end";
    let mut all = vec![figure(
        "Typical paths",
        &chart(&paths, alt),
        "One path of each behaviour, from the origin, with the net displacement to the right. Dashed: the regions where half and nine of ten repeats end.",
    )];
    if !plot.times_s.is_empty() {
        let alt = |axis: &str| format!("{axis}: regions of half and nine of ten repeats over time");
        let dark = "Dark: half of the repeats. Light: nine of ten.";
        all.push(figure("Along the way", &chart(&along, &alt("x")), dark));
        let less = "Less noise at the start and in friction would make the bands narrower.";
        all.push(figure("Across it", &chart(&across, &alt("y")), less));
    }
    let title = within("h3", crate::report::document::page::html(name));
    format!("{title}{}{}", legend(&paths), figures(&all))
}

pub(in crate::report) fn distances(cases: &[Case]) -> String {
    let many = cases.len() > 1;
    let rows = cases.iter().take(40).flat_map(|case| {
        let summary = &case.summary;
        let free = summary.noise_free_displacement_m;
        let quantities = [
            ("net displacement", summary.displacement_m, "m", free),
            ("length of the path", summary.path_length_m, "m", None),
            ("speed", summary.speed_m_s, "m/s", None),
            ("turned", summary.turned_rad, "rad", None),
        ];
        let quantities = quantities.into_iter();
        quantities.filter_map(move |(name, found, unit, free)| {
            let found = found?;
            let name = match many {
                true => format!("{}: {name}", case.case),
                false => name.to_owned(),
            };
            let spread = [found.mean, found.standard_deviation];
            let quantiles = [found.q05, found.q50, found.q95];
            let numbers = spread.into_iter().chain(quantiles).map(Some).chain([free]);
            // People read degrees, as in the terminal.
            let (factor, unit) = match unit {
                "rad" => (1.0_f64.to_degrees(), "deg"),
                unit => (1.0, unit),
            };
            let cells = numbers.map(|value| measured(value.map(|value| factor * value), unit));
            Some(std::iter::once(name).chain(cells).collect())
        })
    });
    let head = " | mean | standard deviation | 5 % | 50 % | 95 % | without noise";
    titled(head, rows)
}

/// How often the regions hold the recorded runs, and the recordings one by one.
fn recorded(report: &EnsembleSummary, reality: &Reality) -> String {
    if reality.coverage.is_empty() {
        return String::new();
    }
    let rows = reality.coverage.iter().map(|level| {
        let name = percent(level.level);
        let said = shown(word(&report.claims, About::Region, &name));
        vec![
            name,
            percent(level.over_time),
            odds(level.at_end),
            said,
            odds(level.whole_path),
        ]
    });
    let first = titled(
        "region of | recorded runs inside, over time | at the end (95 %) | recordings say | whole paths in their band",
        rows,
    );
    let head = "recording | does | net displacement | from its behaviour | energy score";
    let runs = reality.runs.iter().map(|run| {
        vec![
            run.recording.clone(),
            run.behaviour.clone().unwrap_or_default(),
            measured(run.net_displacement_m, "m"),
            measured(run.distance_m, "m"),
            measured(run.energy_score_m, "m"),
        ]
    });
    format!(
        "{first}<p class=\"note\">The energy score is {}; it would be {} if reality were one more repeat. More recordings make the score more precise.</p>{}",
        measured(reality.energy_score_m, "m"),
        measured(reality.expected_energy_score_m, "m"),
        folded("Recording by recording", &titled(head, runs)),
    )
}

pub(in crate::report) fn noise(noise: &Noise) -> String {
    let fields = noise.fields().into_iter();
    let rows = fields.filter(|(_, drawn)| !drawn.is_zero());
    let rows = rows.map(|(name, drawn)| {
        let (kind, size) = match drawn {
            Distribution::Normal(sd) => ("Normal", number(sd)),
            Distribution::Uniform(low, high) => ("Uniform", span(low, high, "")),
            Distribution::HalfNormal(sd) => ("HalfNormal", number(sd)),
            Distribution::LogNormal(sd) => ("LogNormal", number(sd)),
        };
        let name = name.replace('_', " ").replace('.', ": ");
        vec![name, kind.to_owned(), size]
    });
    noted("what | drawn from | size", rows, "")
}
