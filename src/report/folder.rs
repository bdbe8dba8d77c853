//! A results folder as one page: what its own files say, nothing else.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::base64;
use super::block::Block;
use super::heat::{Point, heat_map};
use super::page::{Page, fill, html, script_json};
use crate::error::{Error, Result};
use crate::store::{STORE_FILE, Store, Trial};
use crate::unit::number;

const STYLE: &str = include_str!("page/style.css");
const BLOCK: &str = include_str!("page/block.js");
const REPORT: &str = include_str!("page/report.js");
/// Prepared paths are rounded to this in the page.
const PATH_STEP_M: f64 = 1e-4;
/// Pictures that are larger stay in the folder.
const LARGEST_PICTURE: u64 = 1_500_000;

/// Reports that folders hold, and what they are of.
const REPORTS: [(&str, &str); 4] = [
    ("summary.json", "report"),
    ("ensemble.json", "ensemble"),
    ("gap.json", "gap"),
    ("prediction.json", "prediction"),
];

/// The page of a results folder; `command` is said to have made it.
///
/// # Errors
/// A folder without a report; unreadable files; a damaged store.
pub fn folder_page(folder: &Path, command: &str) -> Result<String> {
    let found = REPORTS.iter().find(|(name, _)| folder.join(name).is_file());
    let Some((file, kind)) = found else {
        return Err(Error::invalid("no finished results here")
            .at_file(folder)
            .allowed("a folder with summary.json, ensemble.json, gap.json or prediction.json")
            .hint("name a folder that sweep, tune, search, ensemble, gap or predict has written"));
    };
    let path = folder.join(file);
    let text = fs::read_to_string(&path).map_err(|e| Error::io("read the file", &path, &e))?;
    let report: Value = serde_json::from_str(&text)
        .map_err(|e| Error::invalid(format!("not a report: {e}")).at_file(&path))?;
    let points = Points::read(folder)?;
    let paths = points.paths(folder)?;
    let has_paths = paths.is_some();
    let title = first_text(&report, &["study", "search", "robot", "name"]).unwrap_or("results");
    let has_map = points.map(&report).is_some();
    let values = [
        ("kind", (*kind).to_owned()),
        ("name", html(title)),
        ("answer", answer(&report)),
        ("description", html(text_of(&report, "description"))),
        ("heat", heat_section(&points, &report, has_paths)),
        ("verdicts", verdict_section(&report)),
        ("pictures", picture_section(folder, has_map)?),
        ("audit", audit_section(&report)),
        ("numbers", number_section(&report)),
        ("warnings", warning_section(&report)),
        ("provenance", provenance_section(&report, command)),
    ];
    let body = fill(include_str!("page/report.html"), &values);
    let data = [
        ("points", script_json(&points.json(has_paths))),
        ("paths", paths.unwrap_or_default()),
    ];
    Ok(Page {
        title: &format!("{title}: report"),
        styles: &[STYLE],
        body: &body,
        data: &data,
        scripts: &[BLOCK, REPORT],
    }
    .text())
}

fn text_of<'a>(value: &'a Value, name: &str) -> &'a str {
    value.get(name).and_then(Value::as_str).unwrap_or_default()
}

fn first_text<'a>(value: &'a Value, names: &[&str]) -> Option<&'a str> {
    let texts = names.iter().map(|name| text_of(value, name));
    texts.into_iter().find(|text| !text.is_empty())
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value
        .get(name)
        .and_then(Value::as_array)
        .map_or(&[], Vec::as_slice)
}

fn float(value: &Value, name: &str) -> Option<f64> {
    value.get(name).and_then(Value::as_f64)
}

/// A score with its unit, or a dash.
fn score_text(score: Option<f64>, unit: &str) -> String {
    score.map_or_else(
        || "–".to_owned(),
        |score| format!("{} {unit}", number(score)),
    )
}

/// Two sentences: where the simulation is nearest, and what the recordings determine.
fn answer(report: &Value) -> String {
    let Some(best) = report
        .get("best")
        .filter(|best| best.get("parameters").is_some())
    else {
        return "What this folder says is in the numbers and pictures below.".to_owned();
    };
    let parameters = best.get("parameters").and_then(Value::as_object);
    let values: Vec<String> = (parameters.into_iter().flatten())
        .map(|(name, value)| {
            format!(
                "{name} = {}",
                value.as_f64().map_or_else(String::new, number)
            )
        })
        .collect();
    let unit = text_of(report, "unit");
    let settings = best.get("settings").and_then(Value::as_u64).unwrap_or(1);
    let over = if settings > 1 {
        format!(" on average over {settings} equally valid numerical settings")
    } else {
        " in one run each, numerical luck included".to_owned()
    };
    let mut text = format!(
        "The simulation comes nearest to the recordings at {}: {} {}{over}.",
        values.join(", "),
        text_of(report, "metric"),
        score_text(float(best, "score"), unit),
    );
    let names = |identified: bool| -> Vec<&str> {
        let verdicts = list(report, "verdicts").iter();
        verdicts
            .filter(|v| v.get("identified").and_then(Value::as_bool) == Some(identified))
            .map(|v| text_of(v, "parameter"))
            .collect()
    };
    let (known, open) = (names(true), names(false));
    text += &match (known.is_empty(), open.is_empty()) {
        (true, true) => " Nothing is said about how sure that is.".to_owned(),
        (false, true) => format!(" The recordings narrow down {}.", known.join(", ")),
        (true, false) => format!(" The recordings do not determine {}.", open.join(", ")),
        (false, false) => format!(
            " The recordings narrow down {}, and do not determine {}.",
            known.join(", "),
            open.join(", ")
        ),
    };
    html(&text)
}

/// The rows of `points.csv`.
struct Points {
    names: Vec<String>,
    points: Vec<Point>,
}

impl Points {
    fn read(folder: &Path) -> Result<Self> {
        let mut all = Self {
            names: Vec::new(),
            points: Vec::new(),
        };
        let path = folder.join("points.csv");
        if !path.is_file() {
            return Ok(all);
        }
        let fail =
            |e: csv::Error| Error::invalid(format!("cannot read the table: {e}")).at_file(&path);
        let mut reader = csv::Reader::from_path(&path).map_err(fail)?;
        let header = reader.headers().map_err(fail)?.clone();
        let Some(score) = header.iter().position(|name| name == "score") else {
            return Ok(all);
        };
        let is_in = header.iter().position(|name| name == "indistinguishable");
        all.names = header.iter().take(score).map(str::to_owned).collect();
        for row in reader.records() {
            let row = row.map_err(fail)?;
            let values: Option<Vec<f64>> = row
                .iter()
                .take(score)
                .map(|cell| cell.parse().ok())
                .collect();
            let Some(values) = values else {
                let line = row.position().map_or(0, csv::Position::line) as usize;
                return Err(Error::invalid("a value is not a number")
                    .at_file(&path)
                    .at_line(line, 1));
            };
            all.points.push(Point {
                values,
                score: row.get(score).and_then(|cell| cell.parse().ok()),
                is_in: is_in.and_then(|column| row.get(column)) == Some("true"),
            });
        }
        Ok(all)
    }

    fn map(&self, report: &Value) -> Option<String> {
        heat_map(&self.points, &self.names, text_of(report, "unit"))
    }

    /// The stored path of every point, coded; `None` where the folder keeps none.
    fn paths(&self, folder: &Path) -> Result<Option<String>> {
        if self.points.is_empty() || !folder.join(STORE_FILE).is_file() {
            return Ok(None);
        }
        let trials = Store::<Trial>::read(folder)?.trials()?;
        let mut block = Block::default();
        let mut is_any = false;
        for point in &self.points {
            // The first run of a point is that with the study's own settings, or the nearest to it.
            let trial = trials.iter().find(|trial| trial.values == point.values);
            let case = trial.and_then(|trial| trial.cases.first()?.completed());
            let path = case.map_or(&[][..], |result| &result.path_xy_m);
            is_any |= !path.is_empty();
            for axis in 0..2 {
                block.push(path.iter().map(|place| place[axis]), PATH_STEP_M);
            }
        }
        Ok(is_any.then(|| block.text()))
    }

    fn json(&self, has_paths: bool) -> Value {
        let rows = self.points.iter();
        json!({
            "names": self.names,
            "step": PATH_STEP_M,
            "has_paths": has_paths,
            "rows": rows.map(|p| json!([p.values, p.score, p.is_in])).collect::<Vec<_>>(),
        })
    }
}

fn heat_section(points: &Points, report: &Value, has_paths: bool) -> String {
    if points.points.is_empty() {
        return String::new();
    }
    let unit = text_of(report, "unit");
    let mut order: Vec<&Point> = points.points.iter().collect();
    let key = |point: &Point| point.score.unwrap_or(f64::INFINITY);
    order.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let head: String = points
        .names
        .iter()
        .map(|n| format!("<th scope=\"col\">{}</th>", html(n)))
        .collect();
    let row = |point: &&Point| {
        let cells: String = point
            .values
            .iter()
            .map(|v| format!("<td>{}</td>", number(*v)))
            .collect();
        let mark = if point.is_in { "yes" } else { "" };
        format!(
            "<tr>{cells}<td>{}</td><td>{mark}</td></tr>",
            html(&score_text(point.score, unit))
        )
    };
    let rows: String = order.iter().map(row).collect();
    let table = format!(
        "<details><summary>Table of {} points, best first</summary><div class=\"scroll\"><table><thead><tr>{head}<th scope=\"col\">score</th><th scope=\"col\">not told from the best</th></tr></thead><tbody>{rows}</tbody></table></div></details>",
        order.len(),
    );
    let Some(map) = points.map(report) else {
        return format!("<section class=\"card\" id=\"map\"><h2>Points</h2>{table}</section>");
    };
    let path = if has_paths {
        "<figure class=\"path\"><h3>Path of the chosen point</h3><svg class=\"chart\" id=\"path\" viewBox=\"0 0 360 340\" role=\"img\" aria-label=\"Path of the chosen point over that of the best one\"></svg><figcaption id=\"chosen\">With JavaScript: choose a cell (click, or arrow keys) to see the path simulated there.</figcaption></figure>"
    } else {
        ""
    };
    format!(
        "<section class=\"card\" id=\"map\"><h2>Score over both parameters</h2><div class=\"pair\"><figure>{map}<figcaption>Light is near to the recordings. Framed: cannot be told apart from the best, which has the thick frame. More recordings, or finer numerics where the audit below says so, would make the framed set smaller.</figcaption></figure>{path}</div>{table}</section>"
    )
}

fn verdict_section(report: &Value) -> String {
    let verdicts = list(report, "verdicts");
    if verdicts.is_empty() {
        return String::new();
    }
    let rows: String = verdicts
        .iter()
        .map(|verdict| {
            let interval = list(verdict, "interval");
            let end = |k: usize| interval.get(k).and_then(Value::as_f64).map(number);
            let interval = match (end(0), end(1)) {
                (Some(low), Some(high)) => format!("{low} to {high}"),
                _ => "–".to_owned(),
            };
            format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td><td>{interval}</td><td class=\"words\">{}</td></tr>",
                html(text_of(verdict, "parameter")),
                float(verdict, "best").map_or_else(String::new, number),
                html(text_of(verdict, "text")),
            )
        })
        .collect();
    format!(
        "<section class=\"card\" id=\"verdicts\"><h2>What the recordings say about each parameter</h2><div class=\"scroll\"><table><thead><tr><th scope=\"col\">parameter</th><th scope=\"col\">best</th><th scope=\"col\">90 % interval</th><th scope=\"col\">verdict</th></tr></thead><tbody>{rows}</tbody></table></div></section>"
    )
}

fn audit_section(report: &Value) -> String {
    let Some(audit) = report.get("audit").filter(|audit| !audit.is_null()) else {
        return String::new();
    };
    let unit = text_of(report, "unit");
    let rows: String = list(audit, "rows")
        .iter()
        .map(|row| {
            let coarser = row.get("coarser").and_then(Value::as_bool) == Some(true);
            format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>",
                html(text_of(row, "setting")),
                if coarser {
                    "coarser"
                } else {
                    "as fine or finer"
                },
                html(&score_text(float(row, "score"), unit)),
                html(&score_text(float(row, "change"), unit)),
            )
        })
        .collect();
    format!(
        "<section class=\"card\" id=\"audit\"><h2>Numerical audit: what no recording can tell</h2><div class=\"scroll\"><table><thead><tr><th scope=\"col\">setting</th><th scope=\"col\">is</th><th scope=\"col\">score then</th><th scope=\"col\">change</th></tr></thead><tbody>{rows}</tbody></table></div></section>"
    )
}

/// What stands directly in the report and is a number or a short text.
fn number_section(report: &Value) -> String {
    let said = [
        "study",
        "description",
        "provenance",
        "warnings",
        "verdicts",
        "audit",
        "best",
    ];
    let mut items = String::new();
    let mut add = |name: &str, value: &Value| {
        let text = match value {
            Value::Number(n) => n.as_f64().map_or_else(
                || n.to_string(),
                |v| if n.is_f64() { number(v) } else { n.to_string() },
            ),
            Value::String(text) => text.clone(),
            Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
            _ => return,
        };
        items += &format!(
            "<dt>{}</dt><dd>{}</dd>",
            html(&name.replace('_', " ")),
            html(&text)
        );
    };
    for (name, value) in report.as_object().into_iter().flatten() {
        if said.contains(&name.as_str()) {
            continue;
        }
        add(name, value);
        for (inner, value) in value.as_object().into_iter().flatten() {
            add(&format!("{name}: {inner}"), value);
        }
    }
    format!("<section class=\"card\" id=\"numbers\"><h2>Numbers</h2><dl>{items}</dl></section>")
}

fn warning_section(report: &Value) -> String {
    let warnings = list(report, "warnings");
    if warnings.is_empty() {
        return String::new();
    }
    let items: String = warnings
        .iter()
        .map(|w| {
            format!(
                "<li><code>{}</code> {}</li>",
                html(text_of(w, "code")),
                html(text_of(w, "message"))
            )
        })
        .collect();
    format!("<section class=\"card\" id=\"warnings\"><h2>Warnings</h2><ul>{items}</ul></section>")
}

fn provenance_section(report: &Value, command: &str) -> String {
    let entries = report.get("provenance").and_then(Value::as_object);
    let mut items = String::new();
    for (name, value) in entries.into_iter().flatten() {
        let text = value
            .as_str()
            .map_or_else(|| value.to_string(), str::to_owned);
        items += &format!("<dt>{}</dt><dd>{}</dd>", html(name), html(&text));
    }
    items + &format!("<dt>this page</dt><dd>{}</dd>", html(command))
}

/// The pictures of the folder, in elements that run nothing: PNG where there is one, because an SVG needs its fonts.
fn picture_section(folder: &Path, has_map: bool) -> Result<String> {
    let mut stems = Vec::new();
    let entries =
        fs::read_dir(folder).map_err(|e| Error::io("look into the results folder", folder, &e))?;
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".png").or(name.strip_suffix(".svg")) else {
            continue;
        };
        // The map of the page is that picture, with values to point at.
        let is_drawn = has_map && stem == "heatmap";
        let is_there = stems.iter().any(|s| s == stem);
        if !is_drawn && !is_there {
            stems.push(stem.to_owned());
        }
    }
    // Paths first, then what they say.
    let rank = |stem: &str| {
        let order = [
            "trajectories",
            "ensemble",
            "prediction",
            "profile",
            "curve",
            "convergence",
            "components",
        ];
        order
            .iter()
            .position(|known| stem.starts_with(known))
            .unwrap_or(order.len())
    };
    stems.sort_by_key(|stem| (rank(stem), stem.clone()));
    let mut figures = String::new();
    for stem in stems {
        let size = |ending: &str| {
            let path = folder.join(format!("{stem}.{ending}"));
            fs::metadata(&path)
                .ok()
                .filter(fs::Metadata::is_file)
                .map(|m| (m.len(), path))
        };
        let (png, svg) = (size("png"), size("svg"));
        let chosen = match (png, svg) {
            (Some(png), _) => Some((png, "image/png")),
            (None, Some(svg)) => Some((svg, "image/svg+xml")),
            (None, None) => None,
        };
        let Some(((bytes, path), kind)) =
            chosen.filter(|((bytes, _), _)| *bytes <= LARGEST_PICTURE)
        else {
            continue;
        };
        let content = fs::read(&path).map_err(|e| Error::io("read the file", &path, &e))?;
        debug_assert!(bytes <= LARGEST_PICTURE);
        let name = html(&stem.replace('_', " "));
        figures += &format!(
            "<figure class=\"card\"><h2>{name}</h2><img alt=\"{name}\" src=\"data:{kind};base64,{}\"></figure>",
            base64::encode(&content)
        );
    }
    Ok(figures)
}
