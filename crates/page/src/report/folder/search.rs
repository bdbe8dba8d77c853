//! The page of a search: the best robots, and what they do with other numerics and engines.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::content::PageContent;
use super::ensemble::ForecastSummary;
use super::tree::read_json;
use crate::plot::{Inline, SeriesKind};
use crate::report::document::page::html;
use crate::report::document::picture::Pictures;
use crate::report::document::section::{Section, chart_figure, figures};
use crate::report::document::value::*;
use crate::results::kind::file;
use crate::results::table::CsvTable;
use crate::results::{BestRobot, History, SearchSummary, fitness_chart};
use realgap_core::error::Result;
use realgap_core::statistics::Proportion;
use realgap_core::unit::Unit;

/// What a page shows of the card of a finalist.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct FinalistCard {
    reruns: Vec<Rerun>,
    prediction: ForecastSummary,
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

/// What the page of a search shows.
#[derive(Debug)]
pub(super) struct SearchContent {
    pub(super) summary: SearchSummary,
    pub(super) history: History,
    pub(super) archive: CsvTable,
    /// The cards of finalists by the names of their files.
    pub(super) cards: BTreeMap<String, FinalistCard>,
}

impl SearchContent {
    /// What the files of a folder say.
    ///
    /// # Errors
    /// A file that is not what was written there.
    pub(super) fn read(folder: &Path, summary: SearchSummary) -> Result<Self> {
        let mut cards = BTreeMap::new();
        for robot in &summary.best {
            if let Some(card) = read_card(folder, robot)? {
                cards.insert(robot.file.clone(), card);
            }
        }
        Ok(Self {
            history: History::of(&CsvTable::read(folder, file::HISTORY)?),
            archive: CsvTable::read(folder, file::ARCHIVE)?,
            cards,
            summary,
        })
    }
}

pub(super) fn content(found: &SearchContent, pictures: &Pictures) -> PageContent {
    let report = &found.summary;
    let drawn = |stem: &str| ["gallery", "fitness", "archive", "paths"].contains(&stem);
    let picture = |id, title, name: &'static str| pictures.section(id, title, |stem| stem == name);
    let archive_title = "Archive: the best robot of each kind";
    let mut archive_section = picture("archive", archive_title, "archive");
    archive_section.html += &archive(&found.archive);
    let history = &found.history;
    PageContent {
        kind: "search",
        name: report.search.clone(),
        claims: report.claims.clone(),
        sections: vec![
            picture("gallery", "The best robots", "gallery"),
            Section::new("finalists", "Finalists, evaluated again", finalists(report)),
            Section::new("cards", "The prediction of each finalist", cards(found)),
            Section::new(
                "parameters",
                "Floor and other parameters",
                parameters(report),
            ),
            picture("routes", "Their paths", "paths"),
            Section::new("history", "History", progress(history, report)),
            archive_section,
            Section::new("lineage", "Lineage of the best", lineage(history, report)),
            Section::new("failures", "Robots that failed", failures(report)),
            pictures.section("pictures", "More pictures", move |stem| !drawn(stem)),
        ],
        shown_fields: "best baseline failures archive search parameters parameter_share",
        ..PageContent::default()
    }
}

/// The parameters that repeats get, where their values come from, and how much of the prediction's width they are.
fn parameters(report: &SearchSummary) -> String {
    if report.parameters.is_empty() {
        return String::new();
    }
    let rows = report.parameters.iter().map(|known| {
        let [low, high] = known.q05_q95;
        let range = match low == high {
            true => String::new(),
            false => span(low, high, &known.unit),
        };
        vec![
            known.parameter.clone(),
            measured(Some(known.median), &known.unit),
            range,
            known.from.clone(),
        ]
    });
    let share = report.parameter_share.as_ref().map_or_else(String::new, |share| {
        format!(
            "<p class=\"note\">With these values drawn, the displacement of the best robot has a standard deviation of {}; with all of them at their medians it has {} ({} repeats each). So {} of its variance comes from not knowing them better.</p>",
            measured(Some(share.sd_m), "m"),
            measured(Some(share.fixed_sd_m), "m"),
            share.repeats,
            percent(Some(share.share)),
        )
    });
    let page = report.posterior_page.as_ref().map_or_else(String::new, |page| {
        let page = html(page);
        format!("<p class=\"note\">The posterior is explained on <a href=\"{page}\">the page of the study</a>.</p>")
    });
    share
        + &page
        + &titled(
            "parameter | median | 90 % of the repeats | where from",
            rows,
        )
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
        "robot | modules | servos | score in the search | score on fresh seeds | net displacement, 90 % | energy | survives other numerics",
        rows,
        "",
    );
    if table.is_empty() {
        return table;
    }
    let from = report.baseline.as_ref().map_or_else(String::new, |start| {
        let score = match &start.failure {
            None => format!(
                "scores {} on the same fresh seeds",
                measured(start.fitness, unit)
            ),
            Some(failure) => format!("has no score: {failure}"),
        };
        let (robot, score) = (html(&start.robot), html(&score));
        format!("<p>The robot that the search started from, {robot}, {score}.</p>")
    });
    format!(
        "{table}{from}<p class=\"note\">The best score of a search is partly luck; fresh seeds show how much. A robot that walks differently at another timestep, or with other substeps, joints or contacts, is ranked last: do not build such a robot.</p>"
    )
}

/// The card of a finalist, where the folder has it.
fn read_card(folder: &Path, robot: &BestRobot) -> Result<Option<FinalistCard>> {
    let file = robot.file.as_str();
    // A name from a report is no path.
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    let path = folder.join("best").join(format!("{file}.json"));
    if file.is_empty() || !file.chars().all(is_name) || !path.is_file() {
        return Ok(None);
    }
    Ok(Some(read_json(&path, "a card")?))
}

fn cards(found: &SearchContent) -> String {
    let robots = found.summary.best.iter();
    let cards = robots.filter_map(|robot| {
        let card = found.cards.get(&robot.file)?;
        Some(folded(&html(&robot.file), &one_card(card)))
    });
    cards.collect()
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
fn progress(history: &History, report: &SearchSummary) -> String {
    let unit = Unit::by_label(&report.unit).unwrap_or(Unit::One);
    let Some(mut plot) = fitness_chart(history, "batch", unit) else {
        return String::new();
    };
    for series in &mut plot.series {
        if series.kind == SeriesKind::Dots {
            // More marks than this are a grey area.
            let every = series.points.len().div_ceil(1500).max(1);
            series.points = series.points.iter().copied().step_by(every).collect();
        }
    }
    let alt = "Fitness of each robot in order, and the best so far";
    figures(&[chart_figure(
        &report.objective,
        &plot,
        &Inline::new(alt),
        "A line of the best fitness that still climbs at its end asks for a larger budget.",
    )])
}

/// The first finalist and its ancestors, the youngest first. Of two parents the first is followed, because a child begins with
/// the body and the gait of its first parent.
fn lineage(history: &History, report: &SearchSummary) -> String {
    let best = report.best.first();
    let best = best.and_then(|robot| robot.file.rsplit('_').next()?.parse().ok());
    let first_parent = |robot: &usize| {
        let parents = &history.0.get(*robot)?.parents;
        parents.split(' ').next()?.parse().ok()
    };
    let mut line: Vec<usize> = std::iter::successors(best, first_parent).collect();
    // A file of others may name a child as its own ancestor.
    line.truncate(history.0.len());
    let rows = line.iter().filter_map(|&robot| {
        let row = history.0.get(robot)?;
        Some(vec![
            robot.to_string(),
            row.batch.clone(),
            row.modules.clone(),
            measured(row.fitness, &report.unit),
            match row.parents.as_str() {
                "" => "drawn".to_owned(),
                both => both.to_owned(),
            },
        ])
    });
    noted(
        "robot | batch | modules | score in the search | parents",
        rows,
        "A child begins with the body and the gait of its first parent.",
    )
}

fn archive(table_of_cells: &CsvTable) -> String {
    let all = table_of_cells.rows();
    if all.is_empty() {
        return String::new();
    }
    let rows = all.iter().take(400).cloned();
    let name = format!("Table of {} filled cells", all.len());
    folded(&name, &table(&table_of_cells.header(), rows))
}

fn failures(report: &SearchSummary) -> String {
    let row = |(reason, count): (&String, &usize)| vec![reason.clone(), count.to_string()];
    noted("why | robots", report.failures.iter().map(row), "")
}
