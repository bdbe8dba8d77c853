//! The story of a search: the best robots, and what becomes of them elsewhere.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, steps};
use super::page::html;
use super::section::{Section, figures, pictures};
use super::sheet::Sheet;
use super::story::Story;
use super::value::{
    at, count, first_text, float, floats, is, list, measured, noted, percent, proportion,
    read_json, span, table, text_of, titled,
};
use realgap_core::error::Result;

pub(super) fn search(folder: &Path, report: &Value) -> Result<Story> {
    let history = Sheet::read(folder, "history.csv")?;
    let drawn = |stem: &str| ["gallery", "fitness", "archive", "paths"].contains(&stem);
    let picture =
        |id, title, name: &'static str| pictures(folder, id, title, move |stem| stem == name);
    let archive = archive(folder)?;
    let mut archive_section =
        picture("archive", "Archive: the best robot of each kind", "archive")?;
    archive_section.html += &archive;
    Ok(Story {
        kind: "search",
        name: first_text(report, &["search"])
            .unwrap_or("search")
            .to_owned(),
        answer: answer(report),
        sections: vec![
            picture("gallery", "The best robots", "gallery")?,
            Section::new("finalists", "Finalists, looked at again", finalists(report)),
            Section::new("cards", "What each would do", cards(folder, report)?),
            picture("routes", "Their paths", "paths")?,
            Section::new("history", "History", progress(&history, report)),
            archive_section,
            Section::new("failures", "Robots that failed", failures(report)),
            pictures(folder, "pictures", "More pictures", move |stem| {
                !drawn(stem)
            })?,
        ],
        said: vec!["best", "baseline", "failures", "archive", "search"],
        ..Story::default()
    })
}

fn answer(report: &Value) -> String {
    let unit = text_of(report, "unit");
    let best = list(report, "best");
    let survivors = best
        .iter()
        .filter(|robot| is(robot, "survives") == Some(true))
        .count();
    let Some(first) = best.first() else {
        return "Not determined: no robot was looked at again. What was found so far is in the history below.".to_owned();
    };
    let holds = if is(first, "survives") == Some(true) {
        "and walks the same under other numerics"
    } else {
        "but does NOT walk the same under other numerics"
    };
    let beats = match (
        float(at(report, "baseline"), "fitness"),
        float(first, "fitness"),
    ) {
        (Some(base), Some(own)) => format!(
            " What it started from is worth {}: {}.",
            measured(Some(base), unit),
            if own > base {
                "it was beaten"
            } else {
                "it was not beaten"
            }
        ),
        _ => String::new(),
    };
    format!(
        "The best robot, {}, is worth {} with new draws ({}), {holds}. It gets at least {} far with a probability of {}, and {survivors} of {} finalists survive.{beats}",
        text_of(first, "file"),
        measured(float(first, "fitness"), unit),
        text_of(report, "objective"),
        measured(float(first, "success_m"), "m"),
        percent(float(first, "success")),
        best.len(),
    )
}

fn finalists(report: &Value) -> String {
    let unit = text_of(report, "unit");
    let rows = list(report, "best").iter().map(|robot| {
        let range = floats(robot, "displacement_q05_q95_m");
        let survives = match (is(robot, "survives"), float(robot, "largest_change")) {
            (Some(true), change) => format!("yes (changes by at most {})", percent(change)),
            (_, Some(change)) => format!(
                "NO: changes by {} at {}",
                percent(Some(change)),
                text_of(robot, "worst_rerun")
            ),
            _ => format!("NO: fails at {}", text_of(robot, "worst_rerun")),
        };
        vec![
            text_of(robot, "file").to_owned(),
            count(robot, "modules").map_or_else(String::new, |n| n.to_string()),
            count(robot, "servos").map_or_else(String::new, |n| n.to_string()),
            measured(float(robot, "search_fitness"), unit),
            measured(float(robot, "fitness"), unit),
            span(range.first().copied(), range.get(1).copied(), "m"),
            measured(float(robot, "joules_per_metre"), "J/m"),
            survives,
        ]
    });
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let baseline = at(report, "baseline");
    let from = if baseline.is_object() {
        let worth = match (text_of(baseline, "failure"), float(baseline, "fitness")) {
            ("", fitness) => measured(fitness, unit),
            (failure, _) => format!("nothing: {failure}"),
        };
        format!(
            "<p>What the search started from, {}, is worth {} with the same draws.</p>",
            html(text_of(baseline, "robot")),
            html(&worth)
        )
    } else {
        String::new()
    };
    format!(
        "{}{from}<p class=\"note\">What was best in the search is partly luck; new draws show how much. A robot that walks otherwise at another timestep, with other substeps, joints or contacts is ranked last: build none of these.</p>",
        titled(
            "robot | modules | servos | in the search | new draws | net displacement, 90 % | energy | survives other numerics",
            rows
        )
    )
}

fn cards(folder: &Path, report: &Value) -> Result<String> {
    let mut all = String::new();
    for robot in list(report, "best") {
        let file = text_of(robot, "file");
        // A name from a report is no path.
        if file.is_empty()
            || !file
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
        {
            continue;
        }
        let path = folder.join("best").join(format!("{file}.json"));
        if !path.is_file() {
            continue;
        }
        let card: Value = read_json(&path, "a card")?;
        all += &format!(
            "<details><summary>{}</summary>{}</details>",
            html(file),
            one_card(&card)
        );
    }
    Ok(all)
}

fn one_card(card: &Value) -> String {
    let reruns = list(card, "reruns").iter().map(|rerun| {
        vec![
            text_of(rerun, "settings").to_owned(),
            measured(float(rerun, "mean_displacement_m"), "m"),
            percent(float(rerun, "change")),
            match (text_of(rerun, "failure"), is(rerun, "survives")) {
                ("", Some(true)) => "yes".to_owned(),
                ("", _) => "NO".to_owned(),
                (failure, _) => format!("NO: {failure}"),
            },
        ]
    });
    let reruns = titled("under | mean displacement | changes by | survives", reruns);
    let behaviours = list(at(card, "prediction.behaviours"), "list")
        .iter()
        .map(|behaviour| {
            vec![
                text_of(behaviour, "name").to_owned(),
                proportion(at(behaviour, "probability")),
                measured(float(behaviour, "mean_displacement_m"), "m"),
            ]
        });
    let head = "behaviour | probability (95 %) | net displacement";
    let behaviours = titled(head, behaviours);
    let success = at(card, "success");
    let success = if success.is_object() {
        format!(
            "<p>At least {} far ({}): {}.</p>",
            measured(float(success, "least_displacement_m"), "m"),
            html(text_of(success, "rule")),
            proportion(at(success, "probability"))
        )
    } else {
        String::new()
    };
    format!(
        "{success}<h3>Under other numerics and engines</h3>{reruns}<h3>Behaviours</h3>{behaviours}"
    )
}

/// Fitness of every robot, and the best so far as steps.
fn progress(history: &Sheet, report: &Value) -> String {
    let fitness = history.numbers("fitness");
    if fitness.iter().all(|f| f.is_nan()) {
        return String::new();
    }
    let finite = fitness.iter().enumerate().filter(|(_, f)| f.is_finite());
    let all: Vec<[f64; 2]> = finite.map(|(index, f)| [index as f64, *f]).collect();
    let mut best = f64::NEG_INFINITY;
    let mut better = all.clone();
    better.retain(|[_, value]| {
        let is_better = *value > best;
        best = best.max(*value);
        is_better
    });
    let mut line = steps(better.into_iter());
    line.push([fitness.len().saturating_sub(1) as f64, best]);
    // More marks than this are a grey area.
    let every = all.len().div_ceil(1500).max(1);
    let marks = all.into_iter().step_by(every).collect();
    let alt = "Fitness of each robot in order, and the best so far";
    let label = format!("fitness [{}]", text_of(report, "unit"));
    let chart = Chart::plain(alt, "robot", label).line("sim", line);
    figures(&[chart.dots("grey", marks).figure(
        text_of(report, "objective"),
        "Line: the best so far. A line that still climbs at its end asks for a larger budget.",
    )])
}

fn archive(folder: &Path) -> Result<String> {
    let sheet = Sheet::read(folder, "archive.csv")?;
    if sheet.rows().is_empty() {
        return Ok(String::new());
    }
    let rows = sheet.rows().iter().take(400).cloned();
    Ok(format!(
        "<details><summary>Table of {} filled cells</summary>{}</details>",
        sheet.rows().len(),
        table(&sheet.header(), rows)
    ))
}

fn failures(report: &Value) -> String {
    let all = at(report, "failures").as_object();
    let rows = all.into_iter().flatten();
    let rows = rows.map(|(reason, count)| vec![reason.clone(), count.to_string()]);
    noted("why | robots", rows, "")
}
