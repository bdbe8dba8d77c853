//! The story of an ensemble: how far, which behaviours, how likely, and what recordings say of it.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, key};
use super::claim::{sentences, word};
use super::section::{Section, figures, pictures};
use super::story::Story;
use super::value::*;
use realgap_core::error::Result;
use realgap_core::unit::number;

/// Colours of behaviours, the first for what was predicted.
const CLASSES: [&str; 6] = ["b0", "b1", "b2", "b3", "b4", "b5"];
/// Charts of more starts than this would hide the first.
const STARTS: usize = 6;

pub(super) fn ensemble(folder: &Path, report: &Value) -> Result<Story> {
    let cases = report.list("cases");
    let first = cases
        .first()
        .map_or(&Value::Null, |case| case.at("summary"));
    let mut motion = String::new();
    for case in cases.iter().take(STARTS) {
        let name = case.text("case");
        let name = if cases.len() > 1 { name } else { "" };
        motion += &charts(name, case.at("summary"));
    }
    if cases.len() > STARTS {
        let all = cases.len();
        let note = format!("{STARTS} of {all} starts; ensemble.json holds all.");
        motion += &format!("<p class=\"note\">{note}</p>");
    }
    let reality = report.at("reality");
    let does = behaviour_table(first, cases);
    Ok(Story {
        kind: "ensemble",
        name: report.named("study", "ensemble"),
        answer: sentences(report, &["ensemble", "reach"]),
        sections: vec![
            Section::new("behaviours", "What it does, and how likely", does),
            Section::new("motion", "Where it will be", motion),
            Section::new("distance", "How far", distances(cases)),
            Section::new(
                "reality",
                "What recordings say of it",
                recorded(report, reality),
            ),
            Section::new("noise", "What repeats differ by", noise(first)),
            pictures(folder, "pictures", "All repeats", |_| true)?,
        ],
        said: vec!["reality", "cases"],
        ..Story::default()
    })
}

pub(super) fn behaviour_table(first: &Value, cases: &[Value]) -> String {
    let many = cases.len() > 1;
    let rows = cases.iter().take(40).flat_map(|case| {
        let list = case.list("summary.behaviours.list");
        list.iter().map(move |behaviour| {
            let mut row = vec![
                behaviour.owned("name"),
                behaviour.proportion("probability"),
                behaviour.measured("mean_displacement_m", "m"),
                behaviour.number("representative"),
            ];
            if many {
                row.insert(0, case.owned("case"));
            }
            row
        })
    });
    let head = "behaviour | probability (95 %) | net displacement | typical repeat";
    let head = if many { "start | " } else { "" }.to_owned() + head;
    let share = first.proportion("diverged");
    let lost = match first.count("diverged.count") {
        Some(1..) => format!("<p>{share} of the repeats diverged.</p>"),
        _ => String::new(),
    };
    format!(
        "{}{lost}<p class=\"note\">Repeats are one behaviour where their paths are nearer than {} to each other. More repeats narrow the probabilities; only other noise or another model moves them.</p>",
        titled(&head, rows),
        first.measured("behaviours.cut_m", "m"),
    )
}

/// Paths of the behaviours with the region of the end, and the regions over time.
pub(super) fn charts(name: &str, summary: &Value) -> String {
    let behaviours = summary.list("behaviours.list");
    let regions = summary.list("envelope.regions");
    let alt = "A typical path of each behaviour, and where half and nine of ten repeats end";
    let ends = regions.last().into_iter();
    let ends = ends.flat_map(|end| [0, 2].map(|level| ellipse(end, level)));
    let mut map = Chart::map(alt).lines("edge", ends);
    for (index, behaviour) in behaviours.iter().enumerate().rev() {
        let places = behaviour.list("path_xy_m").iter();
        let points =
            places.filter_map(|place| Some([place.get(0)?.as_f64()?, place.get(1)?.as_f64()?]));
        map = map.line(CLASSES[index % CLASSES.len()], points.collect());
    }
    let times = summary.floats("envelope.times_s");
    let over_time = |axis: usize, label: &str| {
        // The ellipse's shadow on the axis.
        let band = |level: usize| -> Vec<[f64; 3]> {
            let at_time = times.iter().zip(regions);
            at_time
                .map(|(t, region)| {
                    let middle = region
                        .float(&format!("centre_m.{axis}"))
                        .unwrap_or(f64::NAN);
                    let spread = region
                        .float(&format!("covariance_m2.{}", 2 * axis))
                        .unwrap_or(0.0);
                    let radius = region.float(&format!("radii.{level}")).unwrap_or(0.0);
                    let half = radius * spread.max(0.0).sqrt();
                    [*t, middle - half, middle + half]
                })
                .collect()
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
    if !times.is_empty() {
        let along = over_time(0, "x [m]");
        let dark = "Dark: half of the repeats, light: nine of ten.";
        let across = over_time(1, "y [m]");
        let less = "Less noise at the start and in friction would make the bands narrower.";
        all.push(along.figure("Along the way", dark));
        all.push(across.figure("Across it", less));
    }
    let legend: String = behaviours
        .iter()
        .take(CLASSES.len())
        .enumerate()
        .map(|(index, behaviour)| {
            let name = behaviour.text("name");
            let share = behaviour.likely("probability");
            key(CLASSES[index % CLASSES.len()], &format!("{name}: {share}"))
        })
        .collect();
    let title = if name.is_empty() {
        String::new()
    } else {
        format!("<h3>{}</h3>", super::page::html(name))
    };
    format!(
        "{title}<div class=\"legend\">{legend}</div>{}",
        figures(&all)
    )
}

/// The edge of a region: those points whose Mahalanobis distance is its radius.
fn ellipse(region: &Value, level: usize) -> Vec<[f64; 2]> {
    let (centre, c) = (region.floats("centre_m"), region.floats("covariance_m2"));
    let radius = region.float(&format!("radii.{level}")).unwrap_or(0.0);
    let ([x, y], [xx, xy, yy]) = (centre.as_slice(), c.as_slice()) else {
        return Vec::new();
    };
    // Cholesky: a circle becomes the ellipse.
    let a = xx.max(f64::MIN_POSITIVE).sqrt();
    let b = xy / a;
    let d = (yy - b * b).max(0.0).sqrt();
    (0..=64)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 64.0;
            let (u, v) = (radius * angle.cos(), radius * angle.sin());
            [x + a * u, y + b * u + d * v]
        })
        .collect()
}

pub(super) fn distances(cases: &[Value]) -> String {
    let quantities = [
        ("net displacement", "displacement_m", "m"),
        ("length of the path", "path_length_m", "m"),
        ("speed", "speed_m_s", "m/s"),
        ("turned", "turned_rad", "rad"),
    ];
    let many = cases.len() > 1;
    let rows = cases.iter().take(40).flat_map(|case| {
        let summary = case.at("summary");
        quantities.iter().filter_map(move |(name, field, unit)| {
            let found = summary.get(*field).filter(|found| found.is_object())?;
            let quantile = |q: &str| measured(found.float(q), unit);
            let free = summary.float("noise_free_displacement_m");
            let free = measured(free.filter(|_| *field == "displacement_m"), unit);
            let name = match many {
                true => format!("{}: {name}", case.text("case")),
                false => (*name).to_owned(),
            };
            Some(vec![
                name,
                quantile("mean"),
                quantile("standard_deviation"),
                quantile("q05"),
                quantile("q50"),
                quantile("q95"),
                free,
            ])
        })
    });
    let head = " | mean | standard deviation | 5 % | 50 % | 95 % | without noise";
    titled(head, rows)
}

fn recorded(report: &Value, reality: &Value) -> String {
    let coverage = reality.list("coverage");
    if coverage.is_empty() {
        return String::new();
    }
    let rows = coverage.iter().map(|level| {
        vec![
            level.percent("level"),
            level.percent("over_time"),
            level.proportion("at_end"),
            word(report, "region", &level.percent("level")),
            level.proportion("whole_path"),
        ]
    });
    let first = titled(
        "region of | recorded runs inside, over time | at the end (95 %) | recordings say | whole paths in their band",
        rows,
    );
    let runs = reality.list("runs").iter().map(|run| {
        vec![
            run.owned("recording"),
            run.owned("behaviour"),
            run.measured("net_displacement_m", "m"),
            run.measured("distance_m", "m"),
            run.measured("energy_score_m", "m"),
        ]
    });
    format!(
        "{first}<p class=\"note\">Energy score {}; if reality were one more repeat it would be {}. More recordings make this sharper.</p><details><summary>Recording by recording</summary>{}</details>",
        reality.measured("energy_score_m", "m"),
        reality.measured("expected_energy_score_m", "m"),
        titled(
            "recording | does | net displacement | from its behaviour | energy score",
            runs
        )
    )
}

pub(super) fn noise(summary: &Value) -> String {
    let noise = summary.at("noise");
    let size_of = |size: &Value| match size.as_array().map(Vec::as_slice) {
        Some([low, high]) => Some(span(low.as_f64(), high.as_f64(), "")),
        _ => size.as_f64().filter(|size| *size != 0.0).map(number),
    };
    let row = |name: String, value: &Value| {
        let (kind, size) = value.as_object()?.iter().next()?;
        Some(vec![name, kind.clone(), size_of(size)?])
    };
    let fields = |value: &Value, before: &str| -> Vec<Vec<String>> {
        let fields = value.as_object().into_iter().flatten();
        fields
            .filter_map(|(name, value)| row(format!("{before}{}", name.replace('_', " ")), value))
            .collect()
    };
    let mut rows = fields(noise, "");
    rows.extend(fields(noise.at("camera"), "camera: "));
    noted("what | drawn from | size", rows, "")
}
