//! The story of a search: the best robots, and what becomes of them elsewhere.

use std::path::Path;

use serde::Deserialize;

use crate::report::document::page::html;
use crate::report::document::section::{Section, figures, pictures};
use crate::report::document::value::*;
use crate::report::folder::chart::{Chart, steps};
use crate::report::folder::claim::sentences;
use crate::report::folder::ensemble::Summary;
use crate::report::folder::sheet::Sheet;
use crate::report::folder::story::Story;
use crate::report::folder::tree::read_json;
use crate::results::kind::file;
use crate::results::{BestRobot, SearchSummary};
use realgap_core::error::Result;
use realgap_core::statistics::Proportion;
use realgap_lab::claim::{About, Claim};

/// What a page shows of the card of a finalist.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct FinalistCard {
    claims: Vec<Claim>,
    reruns: Vec<Rerun>,
    prediction: Summary,
    success: Option<Success>,
}

/// What a page shows of a robot under other solver settings.
#[derive(Debug, Deserialize)]
struct Rerun {
    settings: String,
    mean_displacement_m: Option<f64>,
    change: Option<f64>,
    failure: Option<String>,
    survives: bool,
}

/// What a page shows of how likely a robot gets far enough.
#[derive(Debug, Deserialize)]
struct Success {
    least_displacement_m: f64,
    rule: String,
    probability: Proportion,
}

pub(in crate::report) fn search(folder: &Path, report: &SearchSummary) -> Result<Story> {
    let history = Sheet::read(folder, file::HISTORY)?;
    let drawn = |stem: &str| ["gallery", "fitness", "archive", "paths"].contains(&stem);
    let picture =
        |id, title, name: &'static str| pictures(folder, id, title, move |stem| stem == name);
    let archive_title = "Archive: the best robot of each kind";
    let mut archive_section = picture("archive", archive_title, "archive")?;
    archive_section.html += &archive(folder)?;
    Ok(Story {
        kind: "search",
        name: report.search.clone(),
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
        said: "best baseline failures archive search",
        ..Story::default()
    })
}

fn answer(folder: &Path, report: &SearchSummary) -> Result<String> {
    let (unit, best) = (report.unit.as_str(), &report.best);
    let survivors = best.iter().filter(|robot| robot.survives).count();
    let Some(first) = best.first() else {
        return Ok("Not determined: no robot was looked at again. What was found so far is in the history below.".to_owned());
    };
    // The summary has the share alone; the card knows how sure it is.
    let card = card_of(folder, first)?.unwrap_or_default();
    let odds = sentences(&card.claims, &[About::Success]);
    let holds = match first.survives {
        true => "and walks the same under other numerics",
        false => "but does NOT walk the same under other numerics",
    };
    let base = report.baseline.as_ref().and_then(|base| base.fitness);
    let beats = base.zip(first.fitness).map(|(base, own)| {
        let outcome = if own > base { "beaten" } else { "not beaten" };
        let worth = measured(Some(base), unit);
        format!(" What it started from is worth {worth}: it was {outcome}.")
    });
    let beats = beats.unwrap_or_default();
    Ok(format!(
        "The best robot, {}, is worth {} with new draws ({}), {holds}. {odds} {survivors} of {} finalists survive.{beats}",
        first.file,
        measured(first.fitness, unit),
        report.objective,
        best.len(),
    ))
}

fn finalists(report: &SearchSummary) -> String {
    let unit = report.unit.as_str();
    let rows = report.best.iter().map(|robot| {
        let worst = robot.worst_rerun.as_deref().unwrap_or_default();
        let survives = match (robot.survives, robot.largest_change) {
            (true, change) => format!("yes (changes by at most {})", percent(change)),
            (_, Some(change)) => format!("NO: changes by {} at {worst}", percent(change)),
            _ => format!("NO: fails at {worst}"),
        };
        let range_m = robot.displacement_q05_q95_m;
        let [low_m, high_m] = [0, 1].map(|end| range_m.map(|range_m| range_m[end]));
        vec![
            robot.file.clone(),
            robot.modules.to_string(),
            robot.servos.to_string(),
            measured(robot.search_fitness, unit),
            measured(robot.fitness, unit),
            span(low_m, high_m, "m"),
            measured(robot.joules_per_metre, "J/m"),
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
    let from = report.baseline.as_ref().map_or_else(String::new, |start| {
        let worth = match &start.failure {
            None => measured(start.fitness, unit),
            Some(failure) => format!("nothing: {failure}"),
        };
        let (robot, worth) = (html(&start.robot), html(&worth));
        format!(
            "<p>What the search started from, {robot}, is worth {worth} with the same draws.</p>"
        )
    });
    format!(
        "{table}{from}<p class=\"note\">What was best in the search is partly luck; new draws show how much. A robot that walks otherwise at another timestep, with other substeps, joints or contacts is ranked last: build none of these.</p>"
    )
}

/// The card of a finalist, where the folder has it.
fn card_of(folder: &Path, robot: &BestRobot) -> Result<Option<FinalistCard>> {
    let file = robot.file.as_str();
    // A name from a report is no path.
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    let path = folder.join("best").join(format!("{file}.json"));
    if file.is_empty() || !file.chars().all(is_name) || !path.is_file() {
        return Ok(None);
    }
    Ok(Some(read_json(&path, "a card")?))
}

fn cards(folder: &Path, report: &SearchSummary) -> Result<String> {
    let mut all = String::new();
    for robot in &report.best {
        if let Some(card) = card_of(folder, robot)? {
            all += &folded(&html(&robot.file), &one_card(&card));
        }
    }
    Ok(all)
}

fn one_card(card: &FinalistCard) -> String {
    let reruns = card.reruns.iter().map(|rerun| {
        vec![
            rerun.settings.clone(),
            measured(rerun.mean_displacement_m, "m"),
            percent(rerun.change),
            match (&rerun.failure, rerun.survives) {
                (None, true) => "yes".to_owned(),
                (None, false) => "NO".to_owned(),
                (Some(failure), _) => format!("NO: {failure}"),
            },
        ]
    });
    let reruns = titled("under | mean displacement | changes by | survives", reruns);
    let behaviours = card.prediction.behaviours.list.iter().map(|found| {
        let far = measured(found.mean_displacement_m, "m");
        vec![found.name.clone(), odds(found.probability), far]
    });
    let head = "behaviour | probability (95 %) | net displacement";
    let behaviours = titled(head, behaviours);
    let success = card.success.as_ref().map_or_else(String::new, |success| {
        format!(
            "<p>At least {} far ({}): {}.</p>",
            measured(success.least_displacement_m, "m"),
            html(&success.rule),
            odds(success.probability)
        )
    });
    format!(
        "{success}<h3>Under other numerics and engines</h3>{reruns}<h3>Behaviours</h3>{behaviours}"
    )
}

/// Fitness of every robot, and the best so far as steps.
fn progress(history: &Sheet, report: &SearchSummary) -> String {
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
    let label = format!("fitness [{}]", report.unit);
    let chart = Chart::plain(alt, "robot", label).line("sim", line);
    figures(&[chart.dots("grey", marks).figure(
        &report.objective,
        "Line: the best so far. A line that still climbs at its end asks for a larger budget.",
    )])
}

/// The first finalist and its ancestors, youngest first: of two parents the first, whose body and gait a child begins as.
fn lineage(history: &Sheet, report: &SearchSummary) -> String {
    let best = report.best.first();
    let best = best.and_then(|robot| robot.file.rsplit('_').next()?.parse().ok());
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
            measured(fitness.get(robot).copied(), &report.unit),
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
    let name = format!("Table of {} filled cells", sheet.rows().len());
    Ok(folded(&name, &table(&sheet.header(), rows)))
}

fn failures(report: &SearchSummary) -> String {
    let row = |(reason, count): (&String, &usize)| vec![reason.clone(), count.to_string()];
    noted("why | robots", report.failures.iter().map(row), "")
}
