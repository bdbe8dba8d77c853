//! The page of a sweep or a tuning.

use super::claim::sentences;
use super::content::PageContent;
use super::fleet;
use super::joint::joints;
use super::page_data::PageData;
use super::path::{from_above, over_time};
use super::points::{ShownPoints, packed_paths};
use super::summary::StudySummary;
use crate::plot::{HeatMap, Inline, InlineChart};
use crate::report::document::page::{html, script_json};
use crate::report::document::picture::Pictures;
use crate::report::document::section::{Section, chart_figure, figures};
use crate::report::document::value::*;
use crate::results::study::chart::{self, ScoreName};
use crate::results::study::data::{PathXy, Points, StudyData};
use realgap_core::unit::number;
use realgap_lab::calibration::Validation;
use realgap_lab::claim::About;

/// Fields of the report that the sections show.
const SHOWN_FIELDS: &str =
    "study fit best verdicts audit validation transfer reproduction uncertainty tuning pose";

pub(super) fn content(
    report: &StudySummary,
    found: &StudyData,
    pictures: &Pictures,
    data: Option<&PageData>,
) -> PageContent {
    let points = &found.points;
    let best = best(points, report);
    // A robot whose joints alone were recorded goes nowhere.
    let is_of_joints = !found.joints.is_empty() && data.is_none_or(|data| data.recorded.is_empty());
    let paths = found.paths.as_deref().filter(|_| !is_of_joints);
    let paths = paths.map(|paths| with_best(paths, best, data));
    let maps = maps(points, report, best);
    let joints = joints(&found.joints);
    let has_joints = !joints.is_empty();
    let (has_map, has_paths) = (maps.is_some(), paths.is_some() && best.is_some());
    let chosen = from_above(points, paths.as_deref(), best, data, report.recordings);
    let map = scores(points, report, maps.as_ref(), &chosen);
    let over_time = over_time(paths.as_deref(), best, data);
    let unit = report.unit.as_str();
    let held = report.validation.as_ref();
    let held = held.map(|held| validation(held, unit));
    let transfer = report.transfer.as_ref();
    let transfer = transfer.map(|found| fleet::transfer(found, unit));
    let reproduced = report.reproduction.as_ref().map(fleet::reproduction);
    let is_plane = |stem: &str| stem == "components";
    let is_corner = |stem: &str| stem == "corner";
    let is_verdict = |stem: &str| stem == "verdict";
    let is_drawn = move |stem: &str| {
        stem.starts_with("profile_")
            || is_plane(stem)
            || is_corner(stem)
            || is_verdict(stem)
            || (has_joints && stem == "joints")
            || (has_map && (stem == "heatmap" || stem == "heatmap_uncertainty"))
            || (has_paths && stem == "trajectories")
            || stem == "convergence"
    };
    let verdicts_title = "What the recordings say about each parameter";
    let corner_title = "Which values go together";
    let convergence_title = "How the optimizer found the best point";
    let plane_title = "Every run in the first two principal components";
    let robots_title = "Does the answer hold for a robot that it has not seen?";
    let reproduced_title = "How many robots do what was recorded with the shared answer?";
    let audit_title = "Numerical audit: what no recording can resolve";
    let at_a_glance = pictures
        .section("verdicts", verdicts_title, is_verdict)
        .html;
    let verdicts = match verdicts(report, found) {
        none if none.is_empty() => none,
        verdicts => at_a_glance + &verdicts,
    };
    let came = convergence(report, found);
    let joints = Section::new("joints", "Joints over time", joints);
    let map_title = match is_of_joints {
        true => "Scores of the points",
        false => "Scores, and the path of each point",
    };
    let map = Section::new("map", map_title, map);
    let [first, last] = match is_of_joints {
        true => [joints, map],
        false => [map, joints],
    };
    let sections = vec![
        first,
        Section::new("over-time", "The chosen point over time", over_time),
        last,
        Section::new("verdicts", verdicts_title, verdicts),
        pictures.section("corner", corner_title, is_corner),
        Section::new("convergence", convergence_title, came),
        pictures.section("components", plane_title, is_plane),
        Section::new("validation", "On recordings that were held out", held),
        Section::new("robots", robots_title, transfer),
        Section::new("reproduced", reproduced_title, reproduced),
        Section::new("audit", audit_title, audit(report)),
        pictures.section("pictures", "More pictures", |stem| !is_drawn(stem)),
        Section::new("next", "What to do with this answer", next(data)),
    ];
    let is_tuned = report.tuning.is_some();
    PageContent {
        kind: if is_tuned { "tuning" } else { "sweep" },
        name: report.study.clone().unwrap_or("results".to_owned()),
        claims: report.claims.clone(),
        answer: answer(report),
        sections,
        shown_fields: SHOWN_FIELDS,
        data: match (paths, best) {
            (Some(paths), Some(best)) => {
                let shown = ShownPoints::new(points, best, data);
                vec![
                    ("point-data", script_json(&shown)),
                    ("path-data", packed_paths(&paths, data)),
                ]
            }
            _ => Vec::new(),
        },
        ..PageContent::default()
    }
}

/// The point that the report calls the best, else the point with the lowest score.
fn best(points: &Points, report: &StudySummary) -> Option<usize> {
    let named = report.best.as_ref().map(|best| &best.parameters);
    let is_named = |values: &[f64]| {
        let known = points.names.iter().map(|name| named?.get(name));
        let mut both = known.zip(values);
        both.all(|(known, value)| known == Some(value))
    };
    let mut all = points.points.iter();
    all.position(|point| is_named(&point.values))
        .or_else(|| points.lowest())
}

/// The paths with that of the best point: an optimizer's best may have been simulated after all stored points.
fn with_best(paths: &[PathXy], best: Option<usize>, data: Option<&PageData>) -> Vec<PathXy> {
    let mut paths = paths.to_vec();
    if let (Some(best), Some(data)) = (best, data)
        && paths[best].is_empty()
    {
        paths[best].clone_from(&data.best_xy_m);
    }
    paths
}

fn score_name(report: &StudySummary) -> ScoreName {
    ScoreName::of_report(&report.metric, &report.unit)
}

/// The maps over the two parameters of a sweep: mean scores, and half of the width of their 90 % intervals, where these are known. An
/// optimizer's points are no grid.
fn maps(
    points: &Points,
    report: &StudySummary,
    best: Option<usize>,
) -> Option<(HeatMap, Option<HeatMap>)> {
    let axes = chart::complete_grid(points, report.points)?;
    let score = score_name(report);
    let map = chart::heat_map(points, axes, report.points, best, &[], &score);
    let half = |row: &Option<usize>| {
        let (low, high) = points.points[(*row)?].band?;
        Some(0.5 * (high - low))
    };
    let halves: Vec<Option<f64>> = map.table_rows.iter().map(half).collect();
    let is_known = halves.iter().any(Option::is_some);
    let uncertain = is_known.then(|| HeatMap {
        scores: halves,
        colours_to: None,
        score_label: "half of the 90 % interval".to_owned(),
        missing: "not known".to_owned(),
        // Only the map of scores chooses a point.
        table_rows: Vec::new(),
        ..map.clone()
    });
    Some((map, uncertain))
}

/// Whether the model explains the recordings, where it is nearest, and what differs between sets of recordings, below the verdict.
fn answer(report: &StudySummary) -> String {
    let about = [About::Model, About::Best, About::Engines, About::Difference];
    let mut text = sentences(&report.claims, &about);
    if text.is_empty() {
        return "No point has a score, so there is no answer.".to_owned();
    }
    if report.complete == Some(false) {
        text += " The run is unfinished: this is the answer so far.";
    }
    text
}

/// The map of scores beside the path of the chosen point, and the table of all points.
fn scores(
    points: &Points,
    report: &StudySummary,
    maps: Option<&(HeatMap, Option<HeatMap>)>,
    path: &str,
) -> String {
    if points.points.is_empty() {
        return String::new();
    }
    let set = match sentences(&report.claims, &[About::Set]) {
        none if none.is_empty() => none,
        set => format!("<p class=\"note\">{}</p>", html(&set)),
    };
    let map = maps.map_or_else(String::new, |(map, uncertain)| {
        let choose = match path.is_empty() {
            true => "",
            false => " Choose a cell (click, or arrow keys) to see its path, which is that of one run.",
        };
        let [x, y] = [&map.x.label, &map.y.label];
        let alt = format!("Score over {x} and {y}; the same numbers are in the table of points");
        let svg = map.inline(&Inline::new(&alt).id("heat"));
        let mean = match uncertain {
            None => "",
            Some(_) => " A colour is the mean score over all equally valid settings, as all runs together let expect; the table has the single runs.",
        };
        let cut = match map.colours_to {
            None => "",
            Some(_) => " The darkest colour stands for its score and all that are higher.",
        };
        let small = uncertain.as_ref().map_or_else(String::new, |uncertain| {
            let alt = format!("How far the mean score is known over {x} and {y}");
            let svg = uncertain.inline(&Inline::new(&alt));
            format!(
                "<figure class=\"small\">{svg}<figcaption>How far the mean score of each cell is known: half of the width of its 90 % interval.</figcaption></figure>"
            )
        });
        format!(
            "<div><figure>{svg}<figcaption>Bright cells are near to the recordings. The star is the best point. The outline encloses the 95 % confidence set: values that fit as well as the best within the uncertainty.{cut}{mean}{choose} More recordings, or finer numerics where the audit says so, would make the set smaller.</figcaption></figure>{small}</div>"
        )
    });
    format!(
        "{set}<div class=\"pair\">{map}{path}</div>{}",
        table_of_points(points, &report.unit)
    )
}

/// The table of all points, in the order of their mean scores.
fn table_of_points(points: &Points, unit: &str) -> String {
    let has_means = points.points.iter().any(|point| point.band.is_some());
    let mut head: Vec<&str> = points.names.iter().map(String::as_str).collect();
    match has_means {
        true => head.extend(["mean over settings", "90 % interval", "runs"]),
        false => head.push("score"),
    }
    head.push("in the confidence set");
    let rows = points.ranked().into_iter().map(|position| {
        let point = &points.points[position];
        let mut row: Vec<String> = point.values.iter().map(|v| number(*v)).collect();
        row.push(match has_means {
            true => measured(point.mean_score, unit),
            false => measured(point.score, unit),
        });
        if has_means {
            row.push(shown(point.band.map(|(low, high)| span(low, high, unit))));
            row.push(match (point.is_settled(), point.setting) {
                (true, _) => format!("all {}", point.runs),
                (false, Some(setting)) => {
                    format!("one, setting {setting}: {}", measured(point.score, unit))
                }
                (false, None) => format!("{}: {}", point.runs, measured(point.score, unit)),
            });
        }
        row.push(
            if point.is_indistinguishable {
                "yes"
            } else {
                ""
            }
            .to_owned(),
        );
        row
    });
    let count = points.points.len();
    let name = match has_means {
        true => format!(
            "Table of {count} points, best first: those simulated with all settings, then the others"
        ),
        false => format!("Table of {count} points, best first"),
    };
    folded(&name, &table(&head, rows))
}

fn verdicts(report: &StudySummary, found: &StudyData) -> String {
    if report.verdicts.is_empty() {
        return String::new();
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
    let score = score_name(report);
    let profiles = found.profiles.iter().map(|profile| {
        let mut plot = chart::profile(profile, &score);
        // The title above has the whole name, and the note below says what is shown, so that both axes may be short.
        plot.y_label = "lowest score".to_owned();
        if let Some((_, last)) = plot.x.label.rsplit_once('.') {
            plot.x.label = last.to_owned();
        }
        let alt = format!("Lowest score over {}", profile.parameter);
        chart_figure(&profile.parameter, &plot, &Inline::new(&alt), "")
    });
    let profiles: Vec<String> = profiles.collect();
    let note = match profiles.is_empty() {
        true => "",
        false => {
            "<p class=\"note\">Each chart shows the lowest score to be expected at each value of a parameter, whatever the other parameters, and the interval that holds that score with 90 %. Shaded values are in the confidence set. Recordings that react more to the parameter would make the valley steeper.</p>"
        }
    };
    figures(&profiles) + note + &table
}

/// Every score in the order of the optimizer, and the best so far as steps.
fn convergence(report: &StudySummary, found: &StudyData) -> String {
    let Some(plot) = chart::convergence(&found.trials, &score_name(report)) else {
        return String::new();
    };
    let alt = "Score of each point in order, and the best so far";
    figures(&[chart_figure(
        "Score point by point",
        &plot,
        &Inline::new(alt),
        "A line of the best score that still falls at its end asks for a larger budget.",
    )])
}

/// The commands that use the answer.
fn next(data: Option<&PageData>) -> String {
    let all = data.map_or(&[][..], |data| data.next.as_slice());
    let said = all.iter().map(|next| {
        let (purpose, command) = (html(&next.purpose), html(&next.command));
        format!("<p>{purpose}</p><pre><code>{command}</code></pre>")
    });
    said.collect()
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
    let bands = held.bands.iter().map(|bands| {
        let name = format!(
            "samples held out within bands of {} %",
            number(100.0 * bands.level)
        );
        vec![name, format!("{} %", number(100.0 * bands.held_out_share))]
    });
    let rows = rows.map(|(name, value)| vec![name.to_owned(), value]);
    table(&["", "value"], rows.into_iter().chain(bands))
}

fn audit(report: &StudySummary) -> String {
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
        "<p class=\"note\">The best point, simulated again with other settings of the engine: some are as fine or finer, others coarser. What a finer setting changes is a floor: differences of scores below it are numerical errors.</p>{}",
        titled(head, cells)
    )
}
