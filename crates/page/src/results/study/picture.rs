//! The pictures of a results folder: heat map or curve, and paths across the grid.

use std::collections::{BTreeMap, BTreeSet};

use crate::plot::{BestPoint, Caption, HeatMap, LinePlot, Panel, PanelGrid, Truth};
use realgap_core::error::Result;
use realgap_core::unit::{Unit, counted};
use realgap_lab::calibration::{Answer, Fit, Method, PointScore, Study};
use realgap_optimization::{Grid, Range};

use super::cell::{cells, in_set, is_alike};
use super::chart::{self, ScoreName, short};
use super::data::{Point, Points, StudyData};
use super::{corner, interval, joint, plane};
use crate::results::draft::Draft;
use crate::results::kind::file_stem;

/// Draws everything that the points evaluated so far allow.
pub(super) fn draw(
    draft: &mut Draft,
    study: &Study,
    answer: &Answer,
    data: &StudyData,
) -> Result<()> {
    if answer.scores.points.is_empty() {
        return Ok(());
    }
    let map = Map::new(study, answer, data);
    interval::draw(draft, study, answer, &map.subtitle)?;
    let ranges = study.definition().grid.ranges();
    if ranges.len() > 1 {
        map.draw_profiles(draft, data)?;
    }
    if let Some(plot) = map.convergence(data) {
        draft.draw("convergence", &plot)?;
    }
    // Where only joints were recorded there are no paths.
    let has_paths = !joint::is_of_joints(study);
    if has_paths {
        plane::draw(draft, study, answer, &map.subtitle)?;
    }
    corner::draw(draft, study, answer, &map.subtitle)?;
    match ranges {
        [x] => draft.draw("curve", &map.curve(x))?,
        [_, _] => {
            draft.draw("heatmap", &map.slice(0, 1))?;
            if let Some(uncertain) = map.uncertainty() {
                draft.draw("heatmap_uncertainty", &uncertain)?;
            }
            if let Some(runs) = map.single_runs() {
                draft.draw("heatmap_runs", &runs)?;
            }
            draft.draw("heatmap_fitness", &map.fitness()?)?;
        }
        _ if map.cells.is_empty() => {}
        ranges => {
            for first in 0..ranges.len() {
                for second in first + 1..ranges.len() {
                    let pair = [first, second].map(|i| ranges[i].parameter.name.replace('.', "_"));
                    let stem = format!("heatmap_{}_{}", pair[0], pair[1]);
                    draft.draw(&stem, &map.slice(first, second))?;
                }
            }
        }
    }
    let panels = match has_paths {
        false => None,
        true if map.cells.is_empty() => map.best_panels(),
        true => map.panels(),
    };
    if let Some(panels) = panels {
        draft.draw_png("trajectories", &panels)?;
    }
    match joint::plot(study, &data.joints) {
        Some(joints) => draft.draw("joints", &joints),
        None => Ok(()),
    }
}

/// Scores by grid index, with what the captions need.
struct Map<'a> {
    study: &'a Study,
    answer: &'a Answer,
    title: String,
    subtitle: String,
    score: ScoreName,
    /// The point that each cell of the grid shows; empty for an optimizer with more than two parameters.
    cells: Vec<Option<&'a PointScore>>,
    /// Of a sweep: the row of the table that each cell of the grid shows.
    rows: BTreeMap<usize, &'a Point>,
    /// Cells with something that cannot be told from the best.
    alike: BTreeSet<usize>,
}

impl<'a> Map<'a> {
    fn new(study: &'a Study, answer: &'a Answer, data: &'a StudyData) -> Self {
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
            score: ScoreName::of_metric(definition.metric.name(), answer.scores.unit),
            alike: match cells.is_empty() {
                true => BTreeSet::new(),
                false => in_set(study, answer),
            },
            rows: answer
                .scores
                .points
                .iter()
                .map(|point| point.index)
                .zip(&data.points.points)
                .collect(),
            cells,
        }
    }

    /// Subtitle of a picture in which cells stand for points: what a colour is the mean of, and whether the model explains the
    /// recordings.
    fn cell_subtitle(&self) -> String {
        let mean = match (self.study.setting_count(), &self.answer.method) {
            (1, Method::Sweep) => String::new(),
            (1, Method::Tune(_)) => "; colours as all runs (dots) let expect".to_owned(),
            (count, Method::Sweep) => {
                format!("; mean over {count} settings, as all runs let expect")
            }
            (count, Method::Tune(_)) => {
                format!("; mean over {count} settings, as all runs (dots) let expect")
            }
        };
        format!("{}{mean}{}", self.subtitle, self.misfit())
    }

    /// How far the best point is from the recordings, and whether anything explains them; empty where that was not judged.
    fn misfit(&self) -> String {
        let fit = self.answer.report.fit.as_ref();
        let said = fit.and_then(Fit::headline);
        said.map_or_else(String::new, |said| format!("; {said}"))
    }

    fn grid(&self) -> &Grid {
        &self.study.definition().grid
    }

    /// The score that the colour of a cell shows: the mean over all equally valid settings, simulated or as all runs let expect.
    fn score(&self, index: usize) -> Option<f64> {
        match self.answer.method {
            Method::Sweep => self.rows.get(&index)?.mean(),
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
        let point = |at: [f64; 2], score: Option<f64>| Point {
            values: at.to_vec(),
            score,
            ..Point::default()
        };
        let (mut points, mut in_set) = (Vec::new(), Vec::new());
        for (iy, y_value) in y.values().into_iter().enumerate() {
            for (ix, x_value) in x.values().into_iter().enumerate() {
                coordinates[first] = ix;
                coordinates[second] = iy;
                let index = self.grid().index(&coordinates);
                points.push(point([x_value, y_value], self.score(index)));
                if self.alike.contains(&index) {
                    in_set.push(vec![x_value, y_value]);
                }
            }
        }
        let on_grid = points.len();
        let place = |point: &PointScore| [point.values[first], point.values[second]];
        points.extend(self.best().map(|best| point(place(best), best.score)));
        let points = Points {
            names: [x, y].map(|range| range.parameter.name.to_owned()).to_vec(),
            points,
        };
        let mut subtitle = self.cell_subtitle();
        if let (Some(best), true) = (&best, ranges.len() > 2) {
            let others = (0..ranges.len()).filter(|i| *i != first && *i != second);
            let value = |i: usize| short(ranges[i].value(best[i]));
            let fixed = others.map(|i| format!("{} = {}", ranges[i].parameter.name, value(i)));
            let fixed: Vec<String> = fixed.collect();
            subtitle += &format!("; slice through the best point at {}", fixed.join(", "));
        }
        let axes = [x.values(), y.values()];
        let best_row = self.best().map(|_| on_grid);
        HeatMap {
            caption: Caption::new(self.title.clone(), subtitle),
            evaluated: match self.answer.method {
                Method::Sweep => Vec::new(),
                Method::Tune(_) => {
                    let points = self.answer.scores.points.iter();
                    points.map(|point| place(point).into()).collect()
                }
            },
            truth: self.truth(x, Some(y)),
            ..chart::heat_map(&points, axes, on_grid, best_row, &in_set, &self.score)
        }
    }

    /// Half of the width of the score's 90 % interval over both parameters; `None` where no interval is known.
    fn uncertainty(&self) -> Option<HeatMap> {
        let half = |index: usize| {
            let band = match self.answer.method {
                Method::Sweep => self.rows.get(&index)?.band,
                Method::Tune(_) => {
                    let expected = self.answer.expected_with_band(&self.grid().values(index));
                    expected.map(|(_, band)| band)
                }
            };
            let (low, high) = band?;
            Some(0.5 * (high - low))
        };
        let scores: Vec<Option<f64>> = self.cells_of_plane().map(half).collect();
        if scores.iter().all(Option::is_none) {
            return None;
        }
        let name = &self.study.definition().name;
        let title = format!("{name}: how far the mean score is known");
        let subtitle = format!(
            "{}; star and outline as in the map of scores",
            self.subtitle
        );
        Some(HeatMap {
            caption: Caption::new(title, subtitle),
            scores,
            best_score: None,
            colours_to: None,
            score_label: format!("{}, 90 % interval, half of its width", self.score.label),
            ..self.slice(0, 1)
        })
    }

    /// The score of the single run in each cell, where cells are runs with different settings.
    fn single_runs(&self) -> Option<HeatMap> {
        if self.answer.method != Method::Sweep || self.study.setting_count() == 1 {
            return None;
        }
        let runs = self.answer.scores.runs.iter();
        let first: BTreeMap<usize, Option<f64>> = runs.map(|run| (run.index, run.score)).collect();
        let score = |index: usize| first.get(&index).copied().flatten();
        let name = &self.study.definition().name;
        let title = format!("{name}: single runs");
        let subtitle = format!(
            "{}; each cell is one run with one of {} settings, so neighbours differ by chance",
            self.subtitle,
            self.study.setting_count()
        );
        Some(HeatMap {
            caption: Caption::new(title, subtitle),
            scores: self.cells_of_plane().map(score).collect(),
            colours_to: None,
            ..self.slice(0, 1)
        })
    }

    /// The cells of a grid of two parameters, the first one fastest.
    fn cells_of_plane(&self) -> impl Iterator<Item = usize> {
        let ranges = self.grid().ranges();
        let rows = 0..ranges[1].points;
        rows.flat_map(move |iy| (0..ranges[0].points).map(move |ix| self.grid().index(&[ix, iy])))
    }

    /// The difference in the distance travelled over both parameters: the fitness of paper 003 (figure 2).
    fn fitness(&self) -> Result<HeatMap> {
        let expected = self.answer.expected_displacement_errors(self.study)?;
        let own = |index: usize| self.cells[index]?.displacement_error_m;
        let error = |index: usize| match expected.get(index) {
            Some(expected) => own(index).and(Some(*expected)),
            None => own(index),
        };
        let (name, label) = (&self.study.definition().name, &self.score.label);
        let title = format!("{name}: difference in distance travelled (fitness)");
        let subtitle = self.cell_subtitle();
        let subtitle = format!("{subtitle}; star and outline are those of {label}");
        Ok(HeatMap {
            caption: Caption::new(title, subtitle),
            scores: self.cells_of_plane().map(error).collect(),
            best_score: self.best().and_then(|point| point.displacement_error_m),
            score_label: "net displacement, mean difference".to_owned(),
            score_unit: Unit::Metre,
            colours_to: None,
            ..self.slice(0, 1)
        })
    }

    /// The score to be expected at every point that was simulated, and that of the best.
    fn curve(&self, x: &Range) -> LinePlot {
        let points = &self.answer.scores.points;
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|a, b| points[*a].values[0].total_cmp(&points[*b].values[0]));
        order.dedup_by(|a, b| points[*a].values[0] == points[*b].values[0]);
        let best = self.answer.scores.best;
        // The line passes through the best point: the expected score alone may be above it.
        let score = |position: usize| {
            let point = &points[position];
            let expected = self.answer.expected_score(&point.values);
            point.score.map(|own| match best == Some(position) {
                true => own,
                false => expected.unwrap_or(own),
            })
        };
        let drawn = order.iter().map(|&position| {
            let is_in = is_alike(self.answer, position);
            (points[position].values[0], score(position), is_in)
        });
        let best = best.filter(|best| order.contains(best));
        LinePlot {
            caption: Caption::new(self.title.clone(), self.subtitle.clone()),
            best: best.map(|best| BestPoint {
                x: points[best].values[0],
                score: score(best),
            }),
            truth: self.truth(x, None),
            ..chart::curve(x.parameter.name, drawn, &self.score)
        }
    }

    /// The best score that each value of a parameter allows, whatever the others.
    fn draw_profiles(&self, draft: &mut Draft, data: &StudyData) -> Result<()> {
        for (range, profile) in self.grid().ranges().iter().zip(&data.profiles) {
            let (name, parameter) = (&self.study.definition().name, range.parameter.name);
            let remark = "the other parameters take their best values; expected from all runs";
            let title = format!("{name}: lowest score at each {parameter}");
            let plot = LinePlot {
                caption: Caption::new(title, format!("{}; {remark}", self.subtitle)),
                truth: self.truth(range, None),
                ..chart::profile(profile, &self.score)
            };
            let stem = format!("profile_{}", file_stem(range.parameter.name));
            draft.draw(&stem, &plot)?;
        }
        Ok(())
    }

    /// The score of every trial of an optimizer, and the best so far.
    fn convergence(&self, data: &StudyData) -> Option<LinePlot> {
        let Method::Tune(tuned) = &self.answer.method else {
            return None;
        };
        let (name, found_by) = (&self.study.definition().name, tuned.optimizer);
        let title = format!("{name}: what {found_by} found, point by point");
        Some(LinePlot {
            caption: Caption::new(title, self.subtitle.clone()),
            ..chart::convergence(&data.trials, &self.score)?
        })
    }

    /// The nine best points' paths: an optimizer's points lie on no grid.
    fn best_panels(&self) -> Option<PanelGrid> {
        let mut points: Vec<&PointScore> = self.answer.scores.points.iter().collect();
        points.retain(|point| point.score.is_some());
        points.sort_by(|a, b| {
            let score = |point: &PointScore| point.score.unwrap_or(f64::INFINITY);
            score(a).total_cmp(&score(b))
        });
        let best = points.iter().take(9).enumerate();
        let panels = best.map(|(position, point)| self.panel(point, position == 0));
        let what = "the nine best simulated paths, one run each";
        self.panel_grid(what, 3, panels.collect())
    }

    /// Nine panels across the first two parameters, with the other parameters at their best values and the recordings behind: only
    /// the first recording where every recording has its own start. As figure 3 of paper 003.
    fn panels(&self) -> Option<PanelGrid> {
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
        let what = "simulated paths across the grid, one run each";
        self.panel_grid(what, columns.len(), panels)
    }

    fn panel_grid(&self, what: &str, columns: usize, panels: Vec<Panel>) -> Option<PanelGrid> {
        if panels.is_empty() {
            return None;
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
        let (name, label) = (&definition.name, &self.score.label);
        let title = format!("{name}: {what}, {label} above each");
        let real = self.study.real_paths().into_iter().take(most);
        Some(PanelGrid {
            caption: Caption::new(title, shown),
            columns,
            panels,
            reality_m: real.map(|prepared| prepared.xy_m().to_vec()).collect(),
            reality_label: definition.source().reality_label().to_owned(),
            unit: self.answer.scores.unit,
        })
    }

    fn panel(&self, point: &PointScore, is_best: bool) -> Panel {
        let ranges = self.grid().ranges().iter();
        let names: Vec<&str> = ranges.map(|range| range.parameter.name).collect();
        chart::panel(
            &names,
            &point.values,
            point.score,
            &point.path_xy_m,
            is_best,
        )
    }
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
}
