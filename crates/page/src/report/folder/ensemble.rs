//! The story of an ensemble: how far, which behaviours, how likely, and what recordings say of it.

use std::path::Path;

use serde::Deserialize;

use crate::report::document::section::{Section, figures, pictures, within};
use crate::report::document::value::*;
use crate::report::folder::chart::{Chart, key};
use crate::report::folder::claim::{sentences, word};
use crate::report::folder::story::Story;
use realgap_core::error::Result;
use realgap_core::statistics::Proportion;
use realgap_core::unit::number;
use realgap_lab::claim::{About, Claim};
use realgap_lab::prediction::ensemble::{Behaviours, Envelope, Quantiles, Reality, Region};
use realgap_simulation::{Distribution, Noise};

/// Colours of behaviours, the first for what was predicted.
const CLASSES: [&str; 6] = ["b0", "b1", "b2", "b3", "b4", "b5"];
/// Charts of more starts than this would hide the first.
const STARTS: usize = 6;

/// What a page shows of the repeats of a study.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Repeated {
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
    pub(in crate::report) summary: Summary,
}

/// What a page shows of a forecast.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Summary {
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

pub(in crate::report) fn ensemble(folder: &Path, report: &Repeated) -> Result<Story> {
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
    Ok(Story {
        kind: "ensemble",
        name: report.study.clone().unwrap_or("ensemble".to_owned()),
        answer: sentences(&report.claims, &[About::Ensemble, About::Reach]),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", motion),
            Section::new("distance", "How far", distances(cases)),
            Section::new("reality", "What recordings say of it", recorded),
            Section::new("noise", "What repeats differ by", noise),
            pictures(folder, "pictures", "All repeats", |_| true)?,
        ],
        said: "reality cases",
        ..Story::default()
    })
}

/// The behaviours of every start; how near those of one are says the first.
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
        "{}{lost}<p class=\"note\">Repeats are one behaviour where their paths are nearer than {} to each other. More repeats narrow the probabilities; only other noise or another model moves them.</p>",
        titled(&head, rows),
        measured(first.behaviours.cut_m, "m"),
    )
}

/// Paths of the behaviours with the region of the end, and the regions over time.
pub(in crate::report) fn charts(name: &str, summary: &Summary) -> String {
    let behaviours = summary.behaviours.list.as_slice();
    let envelope = summary.envelope.as_ref();
    let (times_s, regions) = envelope.map_or((&[][..], &[][..]), |envelope| {
        (&envelope.times_s[..], &envelope.regions[..])
    });
    let alt = "A typical path of each behaviour, and where half and nine of ten repeats end";
    let ends = regions.last().into_iter();
    let ends = ends.flat_map(|end| [0, 2].map(|level| ellipse(end, level)));
    let mut map = Chart::map(alt).lines("edge", ends);
    for (index, behaviour) in behaviours.iter().enumerate().rev() {
        map = map.line(CLASSES[index % CLASSES.len()], behaviour.path_xy_m.clone());
    }
    let over_time = |axis: usize, label: &str| {
        // The ellipse's shadow on the axis.
        let band = |level: usize| -> Vec<[f64; 3]> {
            let at_time = times_s.iter().zip(regions).map(|(t, region)| {
                let middle = region.centre_m[axis];
                let half = region.radii[level] * region.covariance_m2[2 * axis].max(0.0).sqrt();
                [*t, middle - half, middle + half]
            });
            at_time.collect()
        };
        let inner = band(0);
        let middle = inner.iter().map(|[t, low, high]| [*t, 0.5 * (low + high)]);
        let middle = middle.collect();
        let alt = format!("{label}: regions of half and nine of ten repeats over time");
        let chart = Chart::over_time(alt, label).band(band(2)).band(inner);
        chart.line("sim", middle)
    };
    let mut all = vec![map.figure(
        "Typical paths",
        "One path of each behaviour, from the origin, net displacement to the right. Dashed: where half and nine of ten repeats end.",
    )];
    if !times_s.is_empty() {
        let along = over_time(0, "x [m]");
        let dark = "Dark: half of the repeats, light: nine of ten.";
        let across = over_time(1, "y [m]");
        let less = "Less noise at the start and in friction would make the bands narrower.";
        all.push(along.figure("Along the way", dark));
        all.push(across.figure("Across it", less));
    }
    let legend = CLASSES.iter().zip(behaviours).map(|(class, behaviour)| {
        // In a sentence it says what the interval is.
        let share = odds(behaviour.probability).replacen('(', "(95 %: ", 1);
        key(class, &format!("{}: {share}", behaviour.name))
    });
    let legend: String = legend.collect();
    let title = within("h3", crate::report::document::page::html(name));
    let figures = figures(&all);
    format!("{title}<div class=\"legend\">{legend}</div>{figures}")
}

/// The edge of a region: those points whose Mahalanobis distance is its radius.
fn ellipse(region: &Region, level: usize) -> Vec<[f64; 2]> {
    let ([x, y], [xx, xy, yy]) = (region.centre_m, region.covariance_m2);
    let radius = region.radii[level];
    // Cholesky: a circle becomes the ellipse.
    let a = xx.max(f64::MIN_POSITIVE).sqrt();
    let b = xy / a;
    let d = (yy - b * b).max(0.0).sqrt();
    let points = (0..=64).map(|k| {
        let angle = std::f64::consts::TAU * f64::from(k) / 64.0;
        let (u, v) = (radius * angle.cos(), radius * angle.sin());
        [x + a * u, y + b * u + d * v]
    });
    points.collect()
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
            let numbers = spread.into_iter().chain(quantiles).map(Some);
            let cells = numbers.chain([free]).map(|value| measured(value, unit));
            Some(std::iter::once(name).chain(cells).collect())
        })
    });
    let head = " | mean | standard deviation | 5 % | 50 % | 95 % | without noise";
    titled(head, rows)
}

fn recorded(report: &Repeated, reality: &Reality) -> String {
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
        "{first}<p class=\"note\">Energy score {}; if reality were one more repeat it would be {}. More recordings make this sharper.</p>{}",
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
