//! The story of a search: the best robots, and what becomes of them elsewhere.

use std::path::Path;

use serde_json::Value;

use super::chart::{Chart, steps};
use super::claim::sentences;
use super::page::html;
use super::section::{Section, figures, pictures};
use super::sheet::Sheet;
use super::story::Story;
use super::value::*;
use crate::results::kind::file;
use realgap_core::error::Result;

pub(super) fn search(folder: &Path, report: &Value) -> Result<Story> {
    let history = Sheet::read(folder, file::HISTORY)?;
    let drawn = |stem: &str| ["gallery", "fitness", "archive", "paths"].contains(&stem);
    let picture =
        |id, title, name: &'static str| pictures(folder, id, title, move |stem| stem == name);
    let archive = archive(folder)?;
    let mut archive_section =
        picture("archive", "Archive: the best robot of each kind", "archive")?;
    archive_section.html += &archive;
    Ok(Story {
        kind: "search",
        name: report.named("search", "search"),
        answer: answer(folder, report)?,
        sections: vec![
            picture("gallery", "The best robots", "gallery")?,
            Section::new("finalists", "Finalists, looked at again", finalists(report)),
            Section::new("cards", "What each would do", cards(folder, report)?),
            picture("routes", "Their paths", "paths")?,
            Section::new("history", "History", progress(&history, report)),
            archive_section,
            Section::new("lineage", "Lineage of the best", lineage(&history, report)),
            Section::new("failures", "Robots that failed", failures(report)),
            pictures(folder, "pictures", "More pictures", move |stem| {
                !drawn(stem)
            })?,
        ],
        said: vec!["best", "baseline", "failures", "archive", "search"],
        ..Story::default()
    })
}

fn answer(folder: &Path, report: &Value) -> Result<String> {
    let unit = report.text("unit");
    let best = report.list("best");
    let survivors = best
        .iter()
        .filter(|robot| robot.is("survives") == Some(true))
        .count();
    let Some(first) = best.first() else {
        return Ok("Not determined: no robot was looked at again. What was found so far is in the history below.".to_owned());
    };
    // The summary has the share alone; the card knows how sure it is.
    let card = card_of(folder, first)?;
    let odds = card.map_or_else(String::new, |card| sentences(&card, &["success"]));
    let holds = if first.is("survives") == Some(true) {
        "and walks the same under other numerics"
    } else {
        "but does NOT walk the same under other numerics"
    };
    let base = report.float("baseline.fitness");
    let beats = base.zip(first.float("fitness")).map(|(base, own)| {
        let outcome = if own > base { "beaten" } else { "not beaten" };
        let worth = measured(Some(base), unit);
        format!(" What it started from is worth {worth}: it was {outcome}.")
    });
    let beats = beats.unwrap_or_default();
    Ok(format!(
        "The best robot, {}, is worth {} with new draws ({}), {holds}. {odds} {survivors} of {} finalists survive.{beats}",
        first.text("file"),
        first.measured("fitness", unit),
        report.text("objective"),
        best.len(),
    ))
}

fn finalists(report: &Value) -> String {
    let unit = report.text("unit");
    let rows = report.list("best").iter().map(|robot| {
        let range = ["displacement_q05_q95_m.0", "displacement_q05_q95_m.1"];
        let survives = match (robot.is("survives"), robot.float("largest_change")) {
            (Some(true), change) => format!("yes (changes by at most {})", percent(change)),
            (_, Some(change)) => format!(
                "NO: changes by {} at {}",
                percent(Some(change)),
                robot.text("worst_rerun")
            ),
            _ => format!("NO: fails at {}", robot.text("worst_rerun")),
        };
        vec![
            robot.owned("file"),
            robot.number("modules"),
            robot.number("servos"),
            robot.measured("search_fitness", unit),
            robot.measured("fitness", unit),
            robot.span(range, "m"),
            robot.measured("joules_per_metre", "J/m"),
            survives,
        ]
    });
    let table = noted(
        "robot | modules | servos | in the search | new draws | net displacement, 90 % | energy | survives other numerics",
        rows,
        "",
    );
    if table.is_empty() {
        return table;
    }
    let baseline = report.at("baseline");
    let worth = match (baseline.text("failure"), baseline.float("fitness")) {
        ("", fitness) => measured(fitness, unit),
        (failure, _) => format!("nothing: {failure}"),
    };
    let (robot, worth) = (html(baseline.text("robot")), html(&worth));
    let from = match baseline.is_object() {
        true => format!(
            "<p>What the search started from, {robot}, is worth {worth} with the same draws.</p>"
        ),
        false => String::new(),
    };
    format!(
        "{table}{from}<p class=\"note\">What was best in the search is partly luck; new draws show how much. A robot that walks otherwise at another timestep, with other substeps, joints or contacts is ranked last: build none of these.</p>"
    )
}

/// The card of a finalist, where the folder has it.
fn card_of(folder: &Path, robot: &Value) -> Result<Option<Value>> {
    let file = robot.text("file");
    // A name from a report is no path.
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    let path = folder.join("best").join(format!("{file}.json"));
    if file.is_empty() || !file.chars().all(is_name) || !path.is_file() {
        return Ok(None);
    }
    Ok(Some(read_json(&path, "a card")?))
}

fn cards(folder: &Path, report: &Value) -> Result<String> {
    let mut all = String::new();
    for robot in report.list("best") {
        if let Some(card) = card_of(folder, robot)? {
            let (name, card) = (html(robot.text("file")), one_card(&card));
            all += &format!("<details><summary>{name}</summary>{card}</details>");
        }
    }
    Ok(all)
}

fn one_card(card: &Value) -> String {
    let reruns = card.list("reruns").iter().map(|rerun| {
        vec![
            rerun.owned("settings"),
            rerun.measured("mean_displacement_m", "m"),
            rerun.percent("change"),
            match (rerun.text("failure"), rerun.is("survives")) {
                ("", Some(true)) => "yes".to_owned(),
                ("", _) => "NO".to_owned(),
                (failure, _) => format!("NO: {failure}"),
            },
        ]
    });
    let reruns = titled("under | mean displacement | changes by | survives", reruns);
    let behaviours = card.list("prediction.behaviours.list").iter();
    let behaviours = behaviours.map(|behaviour| {
        vec![
            behaviour.owned("name"),
            behaviour.proportion("probability"),
            behaviour.measured("mean_displacement_m", "m"),
        ]
    });
    let head = "behaviour | probability (95 %) | net displacement";
    let behaviours = titled(head, behaviours);
    let success = card.at("success");
    let success = if success.is_object() {
        format!(
            "<p>At least {} far ({}): {}.</p>",
            success.measured("least_displacement_m", "m"),
            html(success.text("rule")),
            success.proportion("probability")
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
    let label = format!("fitness [{}]", report.text("unit"));
    let chart = Chart::plain(alt, "robot", label).line("sim", line);
    figures(&[chart.dots("grey", marks).figure(
        report.text("objective"),
        "Line: the best so far. A line that still climbs at its end asks for a larger budget.",
    )])
}

/// The first finalist and its ancestors, youngest first: of two parents the first, whose body and gait a child begins as.
fn lineage(history: &Sheet, report: &Value) -> String {
    let best = report.list("best").first();
    let best = best.and_then(|robot| robot.text("file").rsplit('_').next()?.parse().ok());
    let parents = history.texts("parents");
    let first_parent = |robot: &usize| parents.get(*robot)?.split(' ').next()?.parse().ok();
    let mut line: Vec<usize> = std::iter::successors(best, first_parent).collect();
    // A file of others may name a child as its own ancestor.
    line.truncate(history.rows().len());
    let (batches, modules) = (history.texts("generation"), history.texts("modules"));
    let fitness = history.numbers("fitness");
    let rows = line.iter().filter_map(|&robot| {
        Some(vec![
            robot.to_string(),
            (*batches.get(robot)?).to_owned(),
            (*modules.get(robot)?).to_owned(),
            measured(fitness.get(robot).copied(), report.text("unit")),
            match *parents.get(robot)? {
                "" => "drawn".to_owned(),
                both => both.to_owned(),
            },
        ])
    });
    noted(
        "robot | batch | modules | in the search | parents",
        rows,
        "A child begins as its first parent.",
    )
}

fn archive(folder: &Path) -> Result<String> {
    let sheet = Sheet::read(folder, file::ARCHIVE)?;
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
    let all = report.at("failures").as_object();
    let rows = all.into_iter().flatten();
    let rows = rows.map(|(reason, count)| vec![reason.clone(), count.to_string()]);
    noted("why | robots", rows, "")
}
