//! The page that a sweep or a tuning renews while it runs: how far the run is, and what is known so far.

use std::path::Path;

use crate::plot::{HeatMap, Inline, InlineChart};
use crate::report::document::page::{Page, STYLE, html};
use crate::report::document::section::{Section, body, chart_figure};
use crate::report::document::value::{measured, table};
use crate::results::study::chart::{self, ScoreName};
use crate::results::study::data::{Point, Points, TrialRow};
use realgap_core::error::Result;
use realgap_core::unit::{counted, number};
use realgap_lab::calibration::{Scores, Study};
use realgap_optimization::Progress;
use realgap_store::{Store, Trial};

/// Seconds after which a browser loads the page again.
const RENEWED_S: u32 = 2;
/// Points in the table.
const LISTED: usize = 10;

/// What is known of a run that goes on.
#[derive(Debug)]
pub struct LivePage<'a> {
    /// The study.
    pub study: &'a Study,
    /// Whether the points are those of a grid; otherwise an optimizer chooses them.
    pub is_sweep: bool,
    /// The results folder, whose store holds what was simulated.
    pub folder: &'a Path,
    /// How far the run is; `None` before its first point.
    pub progress: Option<Progress>,
    /// What follows the run, once it is over: the page is not renewed any more.
    pub ended: Option<&'a str>,
}

impl LivePage<'_> {
    /// The page: one HTML file.
    ///
    /// # Errors
    /// A damaged store, or paths from which no score can be computed.
    pub fn html(&self) -> Result<String> {
        // Before the first point there is no store.
        let trials = match Store::<Trial>::look(self.folder) {
            Ok(store) => store.trials()?,
            Err(_) => Vec::new(),
        };
        let scores = match trials.is_empty() {
            true => None,
            false => Some(Scores::new(self.study, &trials)?),
        };
        let definition = self.study.definition();
        let sections = scores.as_ref().map_or_else(Vec::new, |scores| {
            vec![
                Section::new("map", "Scores so far", self.map(scores)),
                Section::new("trace", "Score point by point", self.trace(scores)),
                Section::new("points", "The best points so far", self.best_points(scores)),
            ]
        });
        let so_far = scores.as_ref().and_then(|scores| {
            let best = &scores.points[scores.best?];
            let names = self.names();
            let values = names.iter().zip(&best.values);
            let values: Vec<String> = values
                .map(|(name, value)| format!("{name} {}", number(*value)))
                .collect();
            let score = measured(best.score, scores.unit.label());
            Some(format!(
                "The best so far: {} by {}, at {}.",
                score,
                definition.metric.name(),
                values.join(", ")
            ))
        });
        let page_body = format!(
            "<header><p class=\"kicker\">{}</p><h1>{}</h1><p class=\"answer\" id=\"so-far\">{}</p>\
             <p class=\"note\">{}</p></header>\n<main class=\"report\">\n{}</main>",
            match self.is_sweep {
                true => "sweep, so far",
                false => "tuning, so far",
            },
            html(&definition.name),
            html(&format!(
                "{} {}",
                self.how_far(trials.len()),
                so_far.unwrap_or_default()
            )),
            "Scores of single runs: the answer with its verdict is computed at the end.",
            body(&sections)
        );
        let page = Page {
            title: &format!("{}: so far", definition.name),
            styles: &[STYLE],
            body: &page_body,
            data: &[],
            scripts: &[],
            renewed_every_s: self.ended.is_none().then_some(RENEWED_S),
        };
        Ok(page.text())
    }

    /// How far the run is, as a sentence.
    fn how_far(&self, stored: usize) -> String {
        if let Some(ended) = self.ended {
            return format!("{}; {ended}", counted(stored, "run"));
        }
        match self.progress {
            None => "The run begins.".to_owned(),
            Some(Progress {
                finishing: Some(step),
                done,
                total,
                ..
            }) => match total {
                0 => format!("{}; now: {step}.", counted(stored, "run")),
                _ => format!(
                    "{}; now: {step}, {done} of {total}.",
                    counted(stored, "run")
                ),
            },
            Some(Progress { done, total, .. }) => format!("{done} of {total} points."),
        }
    }

    fn names(&self) -> Vec<&'static str> {
        let ranges = self.study.definition().grid.ranges().iter();
        ranges.map(|range| range.parameter.name).collect()
    }

    fn score_name(&self, scores: &Scores) -> ScoreName {
        ScoreName::of_metric(self.study.definition().metric.name(), scores.unit)
    }

    /// The map of a sweep of two parameters; empty otherwise.
    fn map(&self, scores: &Scores) -> String {
        let grid = &self.study.definition().grid;
        if !self.is_sweep || grid.ranges().len() != 2 {
            return String::new();
        }
        let cells = (0..grid.len()).map(|index| {
            let mut points = scores.points.iter();
            let known = points.find(|point| point.index == index);
            Point {
                values: grid.values(index),
                score: known.and_then(|point| point.score),
                ..Point::default()
            }
        });
        let points = Points {
            names: self.names().into_iter().map(str::to_owned).collect(),
            points: cells.collect(),
        };
        let Some(axes) = chart::complete_grid(&points, grid.len()) else {
            return String::new();
        };
        let map = chart::heat_map(
            &points,
            axes,
            grid.len(),
            None,
            &[],
            &self.score_name(scores),
        );
        let map = HeatMap {
            missing: "no score yet".to_owned(),
            // While little is known, all scores are told apart.
            colours_to: None,
            table_rows: Vec::new(),
            ..map
        };
        let svg = map.inline(&Inline::new("Scores of the points so far"));
        format!(
            "<figure>{svg}<figcaption>Bright cells are near to the recordings.</figcaption></figure>"
        )
    }

    /// Every score in the order of the runs, and the best so far.
    fn trace(&self, scores: &Scores) -> String {
        let mut best: Option<f64> = None;
        let rows = scores.runs.iter().map(|run| {
            best = match (best, run.score) {
                (Some(best), Some(score)) => Some(best.min(score)),
                (best, score) => best.or(score),
            };
            TrialRow {
                is_design: false,
                score: run.score,
                best_so_far: best,
            }
        });
        let rows: Vec<TrialRow> = rows.collect();
        let name = self.score_name(scores);
        chart::convergence(&rows, &name).map_or_else(String::new, |plot| {
            let alt = "Score of each run in order, and the best so far";
            chart_figure("", &plot, &Inline::new(alt), "")
        })
    }

    fn best_points(&self, scores: &Scores) -> String {
        let mut points: Vec<_> = scores.points.iter().collect();
        points.sort_by(|a, b| {
            let key = |score: Option<f64>| score.unwrap_or(f64::INFINITY);
            key(a.score).total_cmp(&key(b.score))
        });
        let head = [self.names(), vec!["score", "runs"]].concat();
        let unit = scores.unit.label();
        let rows = points.into_iter().take(LISTED).map(|point| {
            let mut row: Vec<String> = point.values.iter().map(|v| number(*v)).collect();
            row.extend([measured(point.score, unit), point.runs.to_string()]);
            row
        });
        table(&head, rows)
    }
}
