//! The story of a sweep or a tuning.

use std::path::Path;

use crate::report::document::packed::Block;
use crate::report::document::page::{html, script_json};
use crate::report::document::section::{Section, figures, pictures};
use crate::report::document::value::*;
use crate::report::folder::chart::{Chart, steps};
use crate::report::folder::claim::sentences;
use crate::report::folder::fleet;
use crate::report::folder::joint::joints;
use crate::report::folder::page_data::{Kept, recorded_of};
use crate::report::folder::path::{from_above, over_time};
use crate::report::folder::points::{Points, push_path};
use crate::report::folder::sheet::Sheet;
use crate::report::folder::story::Story;
use crate::report::folder::summary::Report;
use crate::results::kind::file;
use realgap_core::error::Result;
use realgap_core::unit::number;
use realgap_lab::calibration::Validation;
use realgap_lab::claim::About;

/// Fewer numbers than this of a report stand in the section of numbers, because others tell them.
const SAID: &str =
    "study fit best verdicts audit validation transfer reproduction uncertainty tuning pose";

pub(in crate::report) fn story(
    folder: &Path,
    report: &Report,
    kept: Option<&Kept>,
) -> Result<Story> {
    let points = Points::read(folder)?;
    let joints = joints(folder)?;
    // A robot whose joints alone were recorded goes nowhere.
    let is_of_joints = !joints.is_empty() && kept.is_none_or(|kept| kept.recorded.is_empty());
    let best = points.best(report);
    let mut paths = points.paths(folder)?.filter(|_| !is_of_joints);
    if let (Some(paths), Some(best), Some(kept)) = (&mut paths, best, kept) {
        // An optimizer's best may have been looked at after all stored points.
        let own = &mut paths.xy_m[best];
        if own.is_empty() {
            own.clone_from(&kept.best_xy_m);
        }
    }
    let map = points.map(report);
    let has_joints = !joints.is_empty();
    let (has_map, has_paths) = (map.is_some(), paths.is_some() && best.is_some());
    let is_tuned = report.tuning.is_some();
    let chosen = from_above(&points, paths.as_ref(), best, kept);
    let map = heat(&points, report, map, &chosen);
    let over_time = over_time(paths.as_ref(), best, kept);
    let verdicts = verdicts(folder, report)?;
    let came = convergence(folder, report)?;
    let unit = report.unit.as_str();
    let held = report.validation.as_ref();
    let held = held.map(|held| validation(held, unit));
    let transfer = report.transfer.as_ref();
    let transfer = transfer.map(|found| fleet::transfer(found, unit));
    let reproduced = report.reproduction.as_ref().map(fleet::reproduction);
    let is_plane = |stem: &str| stem == "components";
    let is_corner = |stem: &str| stem == "corner";
    let corner_title = "Which values go together";
    let plane_title = "Every run in the first two principal components";
    let is_drawn = move |stem: &str| {
        stem.starts_with("profile_")
            || is_plane(stem)
            || is_corner(stem)
            || (has_joints && stem == "joints")
            || (has_map && stem == "heatmap")
            || (has_paths && stem == "trajectories")
            || stem == "convergence"
    };
    let audit_title = "Numerical audit: what no recording can tell";
    let verdict_title = "What the recordings say about each parameter";
    let robots_title = "Does it hold for a robot that it has not seen?";
    let reproduced_title = "In how many robots does the shared answer do what was recorded?";
    let sections = vec![
        Section::new("map", "Scores, and the path of each point", map),
        Section::new("over-time", "The chosen point over time", over_time),
        Section::new("joints", "Joints over time", joints),
        Section::new("verdicts", verdict_title, verdicts),
        pictures(folder, "corner", corner_title, is_corner)?,
        Section::new("convergence", "How the optimizer came there", came),
        pictures(folder, "components", plane_title, is_plane)?,
        Section::new("validation", "On recordings that were held out", held),
        Section::new("robots", robots_title, transfer),
        Section::new("reproduced", reproduced_title, reproduced),
        Section::new("audit", audit_title, audit(report)),
        pictures(folder, "pictures", "More pictures", |stem| !is_drawn(stem))?,
    ];
    let mut story = Story {
        kind: if is_tuned { "tuning" } else { "sweep" },
        name: report.study.clone().unwrap_or("results".to_owned()),
        answer: answer(report),
        sections,
        said: SAID,
        ..Story::default()
    };
    if let (Some(paths), Some(best)) = (paths, best) {
        let mut block = Block::default();
        paths.push(&mut block);
        for path in recorded_of(kept) {
            push_path(&mut block, &path.xy_m);
        }
        let data = points.shown(best, kept);
        story.data = vec![
            ("point-data", script_json(&data)),
            ("path-data", block.text()),
        ];
    }
    Ok(story)
}

/// Whether the model explains the recordings, where it is nearest, and what they say about its parameters.
fn answer(report: &Report) -> String {
    let about = [About::Model, About::Best, About::Engines, About::Parameters];
    let mut text = sentences(&report.claims, &about);
    if text.is_empty() {
        return "No point has a score: nothing is said.".to_owned();
    }
    if report.complete == Some(false) {
        text += " Unfinished: this is what there is so far.";
    }
    text
}

fn heat(points: &Points, report: &Report, map: Option<String>, path: &str) -> String {
    if points.points.is_empty() {
        return String::new();
    }
    let unit = report.unit.as_str();
    let mut order: Vec<_> = points.points.iter().collect();
    order.sort_by(|a, b| {
        let key = |score: Option<f64>| score.unwrap_or(f64::INFINITY);
        key(a.score).total_cmp(&key(b.score))
    });
    let mut head: Vec<&str> = points.names.iter().map(String::as_str).collect();
    head.extend(["score", "not told from the best"]);
    let rows = order.iter().map(|point| {
        let mut row: Vec<String> = point.values.iter().map(|v| number(*v)).collect();
        row.push(measured(point.score, unit));
        row.push(if point.is_in { "yes" } else { "" }.to_owned());
        row
    });
    let name = format!("Table of {} points, best first", order.len());
    let table = folded(&name, &table(&head, rows));
    let alike = match sentences(&report.claims, &[About::Set]) {
        none if none.is_empty() => none,
        alike => format!("<p class=\"note\">{}</p>", html(&alike)),
    };
    let map = map.map_or_else(String::new, |map| {
        let choose = match path.is_empty() {
            true => "",
            false => " Choose a cell (click, or arrow keys) to see its path.",
        };
        format!(
            "<figure>{map}<figcaption>Light is near to the recordings. Framed: cannot be told apart from the best, which has the thick frame.{choose} More recordings, or finer numerics where the audit says so, would make the framed set smaller.</figcaption></figure>"
        )
    });
    format!("{alike}<div class=\"pair\">{map}{path}</div>{table}")
}

fn verdicts(folder: &Path, report: &Report) -> Result<String> {
    if report.verdicts.is_empty() {
        return Ok(String::new());
    }
    let rows = report.verdicts.iter().map(|verdict| {
        let parts = match verdict.intervals.as_slice() {
            [] => verdict.interval.as_slice(),
            many => many,
        };
        let parts = parts.iter().map(|[low, high]| span(*low, *high, ""));
        vec![
            verdict.parameter.clone(),
            measured(verdict.best, &verdict.unit),
            shown(parts.reduce(|all, part| format!("{all} or {part}"))),
            verdict.text.clone(),
        ]
    });
    let table = titled("parameter | best | 90 % interval | verdict", rows);
    let profiles = profiles(folder, report)?;
    let note = match profiles.is_empty() {
        true => "",
        false => {
            "<p class=\"note\">The lowest score to be expected, with the range that holds it with 90 %. Marked: cannot be told apart from the best. A steeper valley needs recordings that react more to the parameter.</p>"
        }
    };
    Ok(figures(&profiles) + note + &table)
}

/// The best score along each parameter, from `profiles.csv`.
fn profiles(folder: &Path, report: &Report) -> Result<Vec<String>> {
    let sheet = Sheet::read(folder, file::PROFILES)?;
    let (x, y) = (sheet.numbers("value"), sheet.numbers("lowest_score"));
    let (names, alike) = (sheet.texts("parameter"), sheet.texts("indistinguishable"));
    let (low, high) = (sheet.numbers("low"), sheet.numbers("high"));
    // Name, points, those of them that cannot be told from the best, and the bands.
    type Line = (Vec<[f64; 2]>, Vec<[f64; 2]>, Vec<[f64; 3]>);
    let mut all: Vec<(&str, Line)> = Vec::new();
    for (index, name) in names.into_iter().enumerate() {
        let (Some(x), Some(y)) = (x.get(index), y.get(index)) else {
            continue;
        };
        if all.last().is_none_or(|(last, ..)| *last != name) {
            all.push((name, Line::default()));
        }
        if let Some((_, (points, marked, bands))) = all.last_mut() {
            points.push([*x, *y]);
            if let (Some(low), Some(high)) = (low.get(index), high.get(index)) {
                bands.push([*x, *low, *high]);
            }
            if alike.get(index) == Some(&"true") {
                marked.push([*x, *y]);
            }
        }
    }
    let unit = report.unit.as_str();
    let score = format!("lowest {} [{unit}]", report.metric);
    let figure = |(name, (points, alike, bands)): (&str, Line)| {
        let alt = format!("Lowest score over {name}");
        let chart = Chart::plain(alt, name, score.clone()).band(bands);
        let chart = chart.line("sim", points);
        chart.dots("in", alike).figure(name, "")
    };
    Ok(all.into_iter().map(figure).collect())
}

/// Every score in the order of the optimizer, and the best so far as steps.
fn convergence(folder: &Path, report: &Report) -> Result<String> {
    let sheet = Sheet::read(folder, file::TRIALS)?;
    let (scores, best) = (sheet.numbers("score"), sheet.numbers("best_so_far"));
    if best.is_empty() {
        return Ok(String::new());
    }
    let numbered = |values: &[f64]| -> Vec<[f64; 2]> {
        let values = values.iter().enumerate();
        let points = values.map(|(index, value)| [index as f64, *value]);
        points.collect()
    };
    let best = numbered(&best).into_iter();
    let best = steps(best.filter(|[_, value]| value.is_finite()));
    let label = format!("{} [{}]", report.metric, report.unit);
    let alt = "Score of each point in order, and the best so far";
    let chart = Chart::plain(alt, "point", label).upwards();
    let chart = chart.line("sim", best).dots("grey", numbered(&scores));
    Ok(figures(&[chart.figure(
        "Score point by point",
        "Line: the best so far. A line that still falls at its end asks for a larger budget.",
    )]))
}

fn validation(held: &Validation, unit: &str) -> String {
    let error = held.difference_standard_error;
    let rows = [
        ("split", held.split.clone()),
        ("fit score", measured(held.fit_score, unit)),
        ("held out score", measured(held.held_out_score, unit)),
        ("difference standard error", measured(error, unit)),
        ("held out recordings", held.held_out_recordings.to_string()),
    ];
    let rows = rows.map(|(name, value)| vec![name.to_owned(), value]);
    table(&["", "value"], rows)
}

fn audit(report: &Report) -> String {
    let rows = report.audit.as_ref().map_or(&[][..], |audit| &audit.rows);
    if rows.is_empty() {
        return String::new();
    }
    let unit = report.unit.as_str();
    let score = report.best.as_ref().map(|best| best.score);
    let cells = rows.iter().map(|row| {
        let share = row.change.zip(score).map(|(change, score)| change / score);
        vec![
            row.setting.clone(),
            match row.coarser {
                true => "coarser".to_owned(),
                false => "as fine or finer".to_owned(),
            },
            measured(row.score, unit),
            measured(row.change, unit),
            percent(share),
        ]
    });
    let head = "setting | is | score then | change | of the best score";
    format!(
        "<p class=\"note\">The best point again under other settings of the engine that are as good or better, or coarser. What a finer setting changes is a floor below which no fit can be trusted.</p>{}",
        titled(head, cells)
    )
}
