//! The pictures of a results folder: heat map or curve, and paths across the grid.

use std::collections::BTreeSet;
use std::path::Path;

use crate::plot::{
    Caption, Curve, HeatMap, Panel, PanelGrid, ScoreScale, Truth, both, draw_curve, draw_heat_map,
    draw_panels,
};
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted};
use realgap_lab::calibration::{Answer, Method, PointScore, Study};
use realgap_optimization::{Grid, Range};

use super::cell::{alike, axis, cells, is_alike};
use super::{convergence, corner, joint, plane};

/// Draws everything that the points evaluated so far allow.
pub(in crate::results) fn draw(folder: &Path, study: &Study, answer: &Answer) -> Result<()> {
    if answer.scores.points.is_empty() {
        return Ok(());
    }
    let map = Map::new(study, answer);
    let ranges = study.definition().grid.ranges();
    if ranges.len() > 1 {
        map.draw_profiles(folder)?;
    }
    if let Method::Tune(tuned) = &answer.method {
        convergence::draw(folder, study, answer, tuned, &map.subtitle)?;
    }
    // Where nothing but joints was recorded nothing goes anywhere.
    let has_paths = !joint::is_of_joints(study);
    if has_paths {
        plane::draw(folder, study, answer, &map.subtitle)?;
    }
    corner::draw(folder, study, answer, &map.subtitle)?;
    match ranges {
        [x] => map.draw_curve(x, folder)?,
        [_, _] => {
            draw_map(folder, "heatmap", &map.slice(0, 1))?;
            draw_map(folder, "heatmap_fitness", &map.fitness())?;
        }
        _ if map.cells.is_empty() => {}
        ranges => {
            for first in 0..ranges.len() {
                for second in first + 1..ranges.len() {
                    let pair = [first, second].map(|i| ranges[i].parameter.name.replace('.', "_"));
                    let stem = format!("heatmap_{}_{}", pair[0], pair[1]);
                    draw_map(folder, &stem, &map.slice(first, second))?;
                }
            }
        }
    }
    let path = folder.join("trajectories.png");
    match has_paths {
        false => Ok(()),
        true if map.cells.is_empty() => map.draw_best_panels(&path),
        true => map.draw_panels(&path),
    }
}

/// Scores by grid index, with what the captions need.
struct Map<'a> {
    study: &'a Study,
    answer: &'a Answer,
    title: String,
    subtitle: String,
    score_label: String,
    /// The run that stands for each point of the grid; empty where there are too many parameters to show an optimizer's so.
    cells: Vec<Option<&'a PointScore>>,
    /// Cells with something that cannot be told from the best.
    alike: BTreeSet<usize>,
}

impl<'a> Map<'a> {
    fn new(study: &'a Study, answer: &'a Answer) -> Self {
        let report = &answer.report;
        let definition = study.definition();
        let cells = cells(study, answer);
        let source = definition.source();
        let mut subtitle = format!(
            "{}: {} {}",
            definition.morphology.name(),
            definition.recordings.len(),
            source.recordings_label()
        );
        if let Method::Tune(tuned) = &answer.method {
            subtitle += &format!("; {} points chosen by {}", report.points, tuned.optimizer);
        }
        if !report.complete {
            let (points, all) = (report.points, report.points_total);
            subtitle += &format!(" - INCOMPLETE: {points} of {all} points");
        }
        Self {
            study,
            answer,
            title: definition.name.clone() + ": distance between simulation and recordings",
            subtitle,
            score_label: format!("{} discrepancy", definition.metric.name()),
            alike: match cells.is_empty() {
                true => BTreeSet::new(),
                false => alike(study, answer),
            },
            cells,
        }
    }

    /// Subtitle of a picture in which cells stand for points.
    fn cell_subtitle(&self) -> String {
        match self.answer.method {
            Method::Sweep => self.subtitle.clone(),
            Method::Tune(_) => format!("{}; colours as all runs (dots) let expect", self.subtitle),
        }
    }

    fn grid(&self) -> &Grid {
        &self.study.definition().grid
    }

    fn score(&self, index: usize) -> Option<f64> {
        match self.answer.method {
            Method::Sweep => self.cells[index]?.score,
            Method::Tune(_) => self.answer.expected_score(&self.grid().values(index)),
        }
    }

    fn best(&self) -> Option<&'a PointScore> {
        Some(&self.answer.scores.points[self.answer.scores.best?])
    }

    fn best_coordinates(&self) -> Option<Vec<usize>> {
        Some(self.grid().nearest(&self.best()?.values))
    }

    fn truth(&self, x: &Range, y: Option<&Range>) -> Option<Truth> {
        let known = &self.study.definition().truth;
        let x = known.value(x.parameter.name)?;
        let y = match y {
            Some(y) => known.value(y.parameter.name)?,
            None => 0.0,
        };
        Some(Truth {
            x,
            y,
            label: "hidden value of the stand-in".to_owned(),
        })
    }

    /// The 2-D slice through the best point along two parameters.
    fn slice(&self, first: usize, second: usize) -> HeatMap {
        let ranges = self.grid().ranges();
        let (x, y) = (&ranges[first], &ranges[second]);
        let best = self.best_coordinates();
        let mut coordinates = best.clone().unwrap_or_else(|| vec![0; ranges.len()]);
        let mut scores = Vec::new();
        let mut indistinguishable = Vec::new();
        for iy in 0..y.points {
            for ix in 0..x.points {
                coordinates[first] = ix;
                coordinates[second] = iy;
                let index = self.grid().index(&coordinates);
                scores.push(self.score(index));
                indistinguishable.push(self.alike.contains(&index));
            }
        }
        let mut subtitle = self.cell_subtitle();
        if let (Some(best), true) = (&best, ranges.len() > 2) {
            let others = (0..ranges.len()).filter(|i| *i != first && *i != second);
            let value = |i: usize| short(ranges[i].value(best[i]));
            let fixed = others.map(|i| format!("{} = {}", ranges[i].parameter.name, value(i)));
            let fixed: Vec<String> = fixed.collect();
            subtitle += &format!("; slice through the best point at {}", fixed.join(", "));
        }
        let place = |point: &PointScore| (point.values[first], point.values[second]);
        HeatMap {
            best_at: self.best().map(place),
            best_score: self.best().and_then(|point| point.score),
            evaluated: match self.answer.method {
                Method::Sweep => Vec::new(),
                Method::Tune(_) => self.answer.scores.points.iter().map(place).collect(),
            },
            best: best.map(|best| (best[first], best[second])),
            indistinguishable,
            truth: self.truth(x, Some(y)),
            ..HeatMap::new(
                Caption::new(self.title.clone(), subtitle),
                [(axis(x), x.values()), (axis(y), y.values())],
                scores,
                (&self.score_label, self.answer.scores.unit),
            )
        }
    }

    /// Over both parameters the difference in distance travelled alone, which paper 003 (figure 2) calls fitness and shows.
    fn fitness(&self) -> HeatMap {
        let ranges = self.grid().ranges();
        let places = (0..ranges[1].points)
            .flat_map(|iy| (0..ranges[0].points).map(move |ix| self.grid().index(&[ix, iy])));
        let error = |index: usize| self.cells[index]?.displacement_error_m;
        let (name, label) = (&self.study.definition().name, &self.score_label);
        let title = format!("{name}: difference in distance travelled (fitness)");
        let subtitle = self.cell_subtitle();
        let subtitle = format!("{subtitle}; star and outline are those of {label}");
        HeatMap {
            caption: Caption::new(title, subtitle),
            scores: places.map(error).collect(),
            best_score: self.best().and_then(|point| point.displacement_error_m),
            score_label: "net displacement, mean difference".to_owned(),
            score_unit: Unit::Metre,
            ..self.slice(0, 1)
        }
    }

    /// Values of a parameter, their scores, and whether they cannot be told from the best.
    fn curve(
        &self,
        range: &Range,
        points: impl Iterator<Item = (f64, Option<f64>, bool)>,
    ) -> Curve {
        let (mut x_values, mut scores, mut indistinguishable) = (vec![], vec![], vec![]);
        for (value, score, is_in) in points {
            x_values.push(value);
            scores.push(score);
            indistinguishable.push(is_in);
        }
        Curve {
            caption: Caption::new(self.title.clone(), self.subtitle.clone()),
            x: axis(range),
            x_values,
            scores,
            score_label: self.score_label.clone(),
            score_unit: self.answer.scores.unit,
            scale: ScoreScale::Auto,
            best: None,
            indistinguishable,
            truth: self.truth(range, None),
        }
    }

    /// The score to be expected at every point that was simulated, and that of the best.
    fn draw_curve(&self, x: &Range, folder: &Path) -> Result<()> {
        let points = &self.answer.scores.points;
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|a, b| points[*a].values[0].total_cmp(&points[*b].values[0]));
        order.dedup_by(|a, b| points[*a].values[0] == points[*b].values[0]);
        let is_in = |position: &usize| is_alike(self.answer, *position);
        let best = self.answer.scores.best;
        // A run that is lucky does not lie below the best point.
        let score = |position: &usize| {
            let point = &points[*position];
            let expected = self.answer.expected_score(&point.values);
            point.score.map(|own| match best == Some(*position) {
                true => own,
                false => expected.unwrap_or(own),
            })
        };
        let drawn = order.iter();
        let curve = Curve {
            best: order.iter().position(|p| best == Some(*p)),
            ..self.curve(x, drawn.map(|p| (points[*p].values[0], score(p), is_in(p))))
        };
        both(folder, "curve", |path| draw_curve(&curve, path))
    }

    /// The best score that each value of a parameter allows, whatever the others.
    fn draw_profiles(&self, folder: &Path) -> Result<()> {
        for (range, profile) in self.grid().ranges().iter().zip(&self.answer.profiles) {
            let (name, parameter) = (&self.study.definition().name, range.parameter.name);
            let remark = "the others wherever that is; as all runs let expect";
            let points = profile.values.iter().zip(&profile.scores);
            let points = points.zip(&profile.indistinguishable);
            let points = points.map(|((value, score), is_in)| (*value, Some(*score), *is_in));
            let title = format!("{name}: lowest score at each {parameter}");
            let curve = Curve {
                caption: Caption::new(title, format!("{}; {remark}", self.subtitle)),
                ..self.curve(range, points)
            };
            let stem = format!("profile_{}", range.parameter.name.replace('.', "_"));
            both(folder, &stem, |path| draw_curve(&curve, path))?;
        }
        Ok(())
    }

    /// The nine best points' paths: an optimizer's points lie on no grid.
    fn draw_best_panels(&self, path: &Path) -> Result<()> {
        let mut points: Vec<&PointScore> = self.answer.scores.points.iter().collect();
        points.retain(|point| point.score.is_some());
        points.sort_by(|a, b| {
            let score = |point: &PointScore| point.score.unwrap_or(f64::INFINITY);
            score(a).total_cmp(&score(b))
        });
        let best = points.iter().take(9).enumerate();
        let panels = best.map(|(position, point)| self.panel(point, position == 0));
        let what = "the nine best simulated paths";
        self.draw_panel_grid(path, what, 3, panels.collect())
    }

    /// Nine panels across the first two parameters, the others at their best, reality behind; the first
    /// recording's where every recording has its own start. As figure 3 of paper 003.
    fn draw_panels(&self, path: &Path) -> Result<()> {
        let ranges = self.grid().ranges();
        let best = self.best_coordinates();
        let mut coordinates = best.clone().unwrap_or_else(|| vec![0; ranges.len()]);
        let mut panels = Vec::new();
        let along = |axis: usize| picks(ranges[axis].points, best.as_ref().map(|b| b[axis]));
        let is_plane = ranges.len() > 1;
        let rows = if is_plane { along(1) } else { vec![0] };
        let columns = along(0);
        for row in rows.iter().rev() {
            for column in &columns {
                coordinates[0] = *column;
                if is_plane {
                    coordinates[1] = *row;
                }
                let index = self.grid().index(&coordinates);
                let is_best = best.as_deref() == Some(&coordinates[..]);
                let Some(point) = self.best().filter(|_| is_best).or(self.cells[index]) else {
                    continue;
                };
                panels.push(self.panel(point, is_best));
            }
        }
        let what = "simulated paths across the grid";
        self.draw_panel_grid(path, what, columns.len(), panels)
    }

    fn draw_panel_grid(
        &self,
        path: &Path,
        what: &str,
        columns: usize,
        panels: Vec<Panel>,
    ) -> Result<()> {
        if panels.is_empty() {
            return Ok(());
        }
        let definition = self.study.definition();
        let settled = self.study.cases().len() == 1;
        let (most, shown) = match settled {
            true => (usize::MAX, self.subtitle.clone()),
            false => {
                let first = &definition.recordings[0].name;
                let all = counted(definition.recordings.len(), "recording");
                let shown = format!("paths of recording {first}; scores are means over {all}");
                (1, shown)
            }
        };
        let (name, label) = (&definition.name, &self.score_label);
        let title = format!("{name}: {what}, {label} above each");
        let real = self.study.real_paths().into_iter().take(most);
        let grid = PanelGrid {
            caption: Caption::new(title, shown),
            columns,
            panels,
            reality_m: real.map(|prepared| prepared.xy_m().to_vec()).collect(),
            reality_label: definition.source().reality_label().to_owned(),
            unit: self.answer.scores.unit,
        };
        draw_panels(&grid, path)
    }

    fn panel(&self, point: &PointScore, is_best: bool) -> Panel {
        let shown = self.grid().ranges().iter().zip(&point.values).take(2);
        let note = shown.map(|(range, value)| {
            let name = range.parameter.name.rsplit('.').next().unwrap_or_default();
            format!("{name} {}", short(*value))
        });
        let note: Vec<String> = note.collect();
        let path = (!point.path_xy_m.is_empty()).then(|| point.path_xy_m.clone());
        Panel {
            score: point.score,
            note: note.join(", "),
            simulated_m: path.into_iter().collect(),
            is_best,
        }
    }
}

fn draw_map(folder: &Path, stem: &str, map: &HeatMap) -> Result<()> {
    both(folder, stem, |path| draw_heat_map(map, path))
}

/// Three indices spread over `0..points`, the middle of each third, one of them moved onto the best.
fn picks(points: usize, best: Option<usize>) -> Vec<usize> {
    let sixths = [1, 3, 5].into_iter();
    let mut picks: Vec<usize> = match points < 3 {
        true => (0..points).collect(),
        false => sixths.map(|k| (k * (points - 1) + 3) / 6).collect(),
    };
    if let Some(best) = best
        && let Some(nearest) = picks.iter_mut().min_by_key(|pick| pick.abs_diff(best))
    {
        *nearest = best;
    }
    picks
}

/// A number as short as it can be said without losing the grid: up to four decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_spread_over_the_grid_and_one_of_them_is_the_best() {
        assert_eq!(picks(21, Some(8)), [3, 8, 17]);
        assert_eq!(picks(21, None), [3, 10, 17]);
        assert_eq!(picks(2, Some(1)), [0, 1]);
        assert_eq!(picks(3, Some(2)), [0, 1, 2]);
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [short(0.43), short(1.0), short(0.05 + 0.1)],
            ["0.43", "1", "0.15"]
        );
    }
}
