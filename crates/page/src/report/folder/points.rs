//! The points of a sweep or a tuning as a page needs them: values, scores, paths.

use std::path::Path;

use serde::Serialize;

use crate::report::document::packed::Block;
use crate::report::folder::heat::{Point, heat_map};
use crate::report::folder::page_data::{Kept, recorded_of};
use crate::report::folder::sheet::Sheet;
use crate::report::folder::summary::Report;
use crate::results::kind::file;
use realgap_core::error::{Error, Result};
use realgap_store::{STORE_FILE, Store, Trial};

/// Prepared paths are rounded to this in the page.
pub(in crate::report) const PATH_STEP_M: f64 = 1e-4;
/// Numbers of all paths together in a page; paths of more points have fewer places.
const MOST_NUMBERS: usize = 180_000;

/// The rows of `points.csv`.
#[derive(Debug, Default)]
pub(in crate::report) struct Points {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// In the order of the file.
    pub points: Vec<Point>,
}

/// Stored paths of the points, each from its first run.
#[derive(Debug)]
pub(in crate::report) struct Paths {
    /// Prepared, metres; empty where a point has none.
    pub xy_m: Vec<Vec<[f64; 2]>>,
}

/// What scripts show of points and recorded paths.
#[derive(Debug, Serialize)]
pub(in crate::report) struct ShownPoints<'a> {
    names: &'a [String],
    best: usize,
    /// Values, score, whether it cannot be told from the best.
    rows: Vec<(&'a [f64], Option<f64>, bool)>,
    /// What coordinates are whole multiples of, metres.
    step: f64,
    duration_s: f64,
    /// Name and length in seconds.
    recorded: Vec<(&'a str, f64)>,
}

impl Points {
    pub fn read(folder: &Path) -> Result<Self> {
        let sheet = Sheet::read(folder, file::POINTS)?;
        let header = sheet.header();
        let Some(score) = header.iter().position(|name| *name == "score") else {
            return Ok(Self::default());
        };
        let is_in = header.iter().position(|name| *name == "indistinguishable");
        let names = header[..score].iter().map(|name| (*name).to_owned());
        let point = |(index, row): (usize, &Vec<String>)| {
            let values = row[..score].iter().map(|cell| cell.parse().ok());
            let values: Option<Vec<f64>> = values.collect();
            let fail = || {
                let error = Error::invalid("a value is not a number");
                let error = error.at_file(folder.join(file::POINTS));
                error.at_line(index + 2, 1)
            };
            Ok(Point {
                values: values.ok_or_else(fail)?,
                score: row[score].parse().ok(),
                is_in: is_in.is_some_and(|column| row[column] == "true"),
            })
        };
        let rows = sheet.rows().iter().enumerate();
        Ok(Self {
            names: names.collect(),
            points: rows.map(point).collect::<Result<_>>()?,
        })
    }

    /// The map of scores over two parameters: those of the grid, which come first; of an optimizer's points none.
    pub fn map(&self, report: &Report) -> Option<String> {
        let best = self.best(report);
        let best = best.map(|best| self.points[best].values.as_slice());
        let score = [report.metric.as_str(), report.unit.as_str()];
        heat_map(&self.points, report.points, best, &self.names, score)
    }

    /// The point that the report calls the best, else that of the lowest score.
    pub fn best(&self, report: &Report) -> Option<usize> {
        let named = report.best.as_ref().map(|best| &best.parameters);
        let is_named = |point: &Point| {
            let values = self.names.iter().map(|name| named?.get(name));
            let mut both = values.zip(&point.values);
            both.all(|(named, value)| named == Some(value))
        };
        let lowest = || {
            let scored = self.points.iter().enumerate();
            let scored = scored.filter_map(|(index, point)| Some((index, point.score?)));
            Some(scored.min_by(|a, b| a.1.total_cmp(&b.1))?.0)
        };
        self.points.iter().position(is_named).or_else(lowest)
    }

    /// The stored path of every point; `None` where the folder keeps none.
    pub fn paths(&self, folder: &Path) -> Result<Option<Paths>> {
        if self.points.is_empty() || !folder.join(STORE_FILE).is_file() {
            return Ok(None);
        }
        let trials = Store::<Trial>::read(folder)?.trials()?;
        let path = |point: &Point| {
            // The first run of a point is that with the study's own settings, or the nearest to it.
            let trial = trials.iter().find(|trial| trial.values == point.values);
            let case = trial.and_then(|trial| trial.cases.first()?.completed());
            case.map_or_else(Vec::new, |result| result.path_xy_m.clone())
        };
        let xy_m: Vec<_> = self.points.iter().map(path).collect();
        let is_any = xy_m.iter().any(|path| !path.is_empty());
        Ok(is_any.then_some(Paths { xy_m }))
    }

    /// The points for the scripts, beside the paths that were recorded.
    pub fn shown<'a>(&'a self, best: usize, kept: Option<&'a Kept>) -> ShownPoints<'a> {
        let rows = self.points.iter();
        let rows = rows.map(|p| (p.values.as_slice(), p.score, p.is_in));
        let recorded = recorded_of(kept).iter();
        let recorded = recorded.map(|path| (path.name.as_str(), path.duration_s));
        ShownPoints {
            names: &self.names,
            best,
            rows: rows.collect(),
            step: PATH_STEP_M,
            duration_s: kept.map_or(1.0, |kept| kept.duration_s),
            recorded: recorded.collect(),
        }
    }
}

impl Paths {
    /// Adds the paths to a block, x then y of each.
    pub fn push(&self, block: &mut Block) {
        let numbers: usize = self.xy_m.iter().map(|path| 2 * path.len()).sum();
        let every = numbers.div_ceil(MOST_NUMBERS).max(1);
        for path in &self.xy_m {
            push_path(block, &thinned(path, path.len().div_ceil(every)));
        }
    }
}

/// Adds a path to a block, x then y.
pub(in crate::report) fn push_path(block: &mut Block, xy_m: &[[f64; 2]]) {
    for axis in 0..2 {
        block.push(xy_m.iter().map(|place| place[axis]), PATH_STEP_M);
    }
}

/// A path of `count` places, again at equal steps of time.
fn thinned(path: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    if count >= path.len() || count < 2 {
        return path.to_vec();
    }
    let step = (path.len() - 1) as f64 / (count - 1) as f64;
    let place = |k: usize| {
        let at = k as f64 * step;
        let below = (at.floor() as usize).min(path.len() - 2);
        let (a, b) = (path[below], path[below + 1]);
        let share = at - below as f64;
        [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * share)
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_path_keeps_its_ends_and_its_pace() {
        let path: Vec<[f64; 2]> = (0..=10)
            .map(|k| [f64::from(k), -2.0 * f64::from(k)])
            .collect();
        assert_eq!(
            thinned(&path, 3),
            [[0.0, -0.0], [5.0, -10.0], [10.0, -20.0]]
        );
        assert_eq!(thinned(&path, 11), path);
    }
}
