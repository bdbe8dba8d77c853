//! Charts of a sweep or a tuning. Each is built by one function, for its PNG and SVG files and for the page.

use std::collections::BTreeSet;

use super::data::{Point, Points, ProfileCurve, TrialRow};
use crate::plot::{
    AxisSpec, Caption, HeatMap, LinePlot, Panel, PathPoint, ScoreScale, Series, SeriesKind,
};
use realgap_core::statistics::ends_of;
use realgap_core::unit::Unit;
use realgap_simulation::parameter;

/// What the scores of a study are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScoreName {
    /// The metric's name, with what it measures: `rms discrepancy`.
    pub label: String,
    /// The unit of the scores.
    pub unit: Unit,
}

impl ScoreName {
    /// The scores of a metric.
    pub(crate) fn of_metric(metric: &str, unit: Unit) -> Self {
        Self {
            label: format!("{metric} discrepancy"),
            unit,
        }
    }

    /// The scores of a metric whose unit stands in a report; a unit that is not known stays in the name.
    pub(crate) fn of_report(metric: &str, unit: &str) -> Self {
        match Unit::by_label(unit) {
            Some(unit) => Self::of_metric(metric, unit),
            None => Self {
                label: format!("{metric} discrepancy ({unit})"),
                unit: Unit::One,
            },
        }
    }

    fn pair(&self) -> (&str, Unit) {
        (&self.label, self.unit)
    }
}

/// A parameter as an axis; a name that is no parameter's has no unit.
pub(crate) fn parameter_axis(name: &str) -> AxisSpec {
    let unit = parameter::by_name(name).map_or(Unit::One, |known| known.unit);
    AxisSpec::new(name, unit)
}

/// The values that a parameter takes in these points, increasing.
fn values_of(points: &Points, parameter: usize) -> Vec<f64> {
    let mut all: Vec<f64> = points.points.iter().map(|p| p.values[parameter]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The position of the value that is nearest to this one.
fn nearest(values: &[f64], value: f64) -> usize {
    let distance = |at: &usize| (values[*at] - value).abs();
    (0..values.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}

/// The most values on one side of a heat map. With more values, the cells are too small to point at with a mouse.
const CELLS_AT_MOST: usize = 200;

/// The values of both parameters of a sweep; `None` where the first `on_grid` points are no complete grid of two parameters.
pub(crate) fn complete_grid(points: &Points, on_grid: usize) -> Option<[Vec<f64>; 2]> {
    let grid = Points {
        names: points.names.clone(),
        points: points.points[..on_grid.min(points.points.len())].to_vec(),
    };
    if grid.names.len() != 2 || grid.points.is_empty() {
        return None;
    }
    let axes = [0, 1].map(|parameter| values_of(&grid, parameter));
    let is_short = axes.iter().all(|values| values.len() <= CELLS_AT_MOST);
    let cells = axes[0].len() * axes[1].len();
    (is_short && cells == grid.points.len()).then_some(axes)
}

/// The mean score over two parameters, a cell a point of the grid; a cell without a point has no score. The points behind the
/// first `on_grid` may lie between those of the grid, and so may the `best`. `in_set` are further cells that cannot be told from the
/// best.
pub(crate) fn heat_map(
    points: &Points,
    [x_values, y_values]: [Vec<f64>; 2],
    on_grid: usize,
    best: Option<usize>,
    in_set: &[Vec<f64>],
    score: &ScoreName,
) -> HeatMap {
    let columns = x_values.len();
    let cells = columns * y_values.len();
    let cell_of = |values: &[f64]| (nearest(&x_values, values[0]), nearest(&y_values, values[1]));
    let cell = |(ix, iy): (usize, usize)| iy * columns + ix;
    let mut table_rows = vec![None; cells];
    for (row, point) in points.points.iter().take(on_grid).enumerate() {
        table_rows[cell(cell_of(&point.values))] = Some(row);
    }
    let scores = table_rows.iter();
    let scores = scores.map(|row| points.points[(*row)?].mean());
    let scores: Vec<Option<f64>> = scores.collect();
    let on_grid = points.points.iter().take(on_grid);
    let marked = on_grid.filter(|p| p.is_indistinguishable);
    let marked = marked.map(|point| point.values.as_slice());
    let in_set = in_set.iter().map(Vec::as_slice).filter(|v| v.len() == 2);
    let in_set: BTreeSet<usize> = marked.chain(in_set).map(|v| cell(cell_of(v))).collect();
    let best = best.map(|best| &points.points[best]);
    let axes = [(0, &x_values), (1, &y_values)].map(|(parameter, values)| {
        let name = points.names.get(parameter).map_or("", String::as_str);
        (parameter_axis(name), values.clone())
    });
    HeatMap {
        best: best.map(|best| cell_of(&best.values)),
        best_at: best.map(|best| (best.values[0], best.values[1])),
        best_score: best.and_then(Point::mean),
        colours_to: colours_to(&scores, &in_set),
        indistinguishable: (0..cells).map(|c| in_set.contains(&c)).collect(),
        table_rows: table_rows.clone(),
        ..HeatMap::new(Caption::default(), axes, scores, score.pair())
    }
}

/// Colours end at the score that is so many times as far above the lowest as the highest score of the confidence set is, and not below
/// this share of all scores.
const VALLEYS: f64 = 3.0;
const SHARE_IN_COLOURS: f64 = 0.3;

/// The score from which on all cells have the last colour, so that the valley keeps its contrast; `None` where nothing is gained.
fn colours_to(scores: &[Option<f64>], in_set: &BTreeSet<usize>) -> Option<f64> {
    let mut known: Vec<f64> = scores.iter().copied().flatten().collect();
    known.sort_by(f64::total_cmp);
    let (lowest, highest) = (*known.first()?, *known.last()?);
    let of_set = in_set.iter().filter_map(|cell| scores[*cell]);
    let (_, farthest) = ends_of(of_set);
    let share = known[((known.len() - 1) as f64 * SHARE_IN_COLOURS) as usize];
    let end = (lowest + VALLEYS * (farthest - lowest)).max(share);
    (end.is_finite() && end > lowest && end < highest).then_some(end)
}

/// A score over the values of one parameter.
pub(super) fn curve(
    parameter: &str,
    points: impl Iterator<Item = (f64, Option<f64>, bool)>,
    score: &ScoreName,
) -> LinePlot {
    let (mut values, mut scores, mut in_set) = (vec![], vec![], vec![]);
    for (value, score, is_in) in points {
        values.push(value);
        scores.push(score);
        in_set.push(is_in);
    }
    LinePlot::over_parameter(
        Caption::default(),
        parameter_axis(parameter),
        score.pair(),
        values,
        &scores,
        in_set,
    )
}

/// The lowest score that each value of a parameter allows, whatever the other parameters, with the range that holds it.
pub(crate) fn profile(profile: &ProfileCurve, score: &ScoreName) -> LinePlot {
    let points = profile.values.iter().zip(&profile.scores);
    let points = points.zip(&profile.indistinguishable);
    let points = points.map(|((value, score), is_in)| (*value, Some(*score), *is_in));
    let mut plot = curve(&profile.parameter, points, score);
    let [low, high] = &profile.bands;
    let edge = profile.values.iter().copied().zip(low.iter().copied());
    let band = SeriesKind::Band(high.clone());
    // A legend names what is drawn only: a fit by least squares knows its score exactly.
    if low == high {
        return plot;
    }
    let label = "90 % interval of the score";
    let band = Series::new(label, band, edge.collect()).colour(5);
    plot.series.insert(0, band);
    plot
}

/// The score of every trial and the best so far, over the number of simulations; `None` where no trial has a score.
pub(crate) fn convergence(trials: &[TrialRow], score: &ScoreName) -> Option<LinePlot> {
    let numbered = |value: fn(&TrialRow) -> Option<f64>| -> Vec<(f64, f64)> {
        let all = (1..=trials.len()).zip(trials);
        let known = all.filter_map(|(n, trial)| Some((n as f64, value(trial)?)));
        known.collect()
    };
    let scores = numbered(|trial| trial.score);
    if scores.is_empty() {
        return None;
    }
    let (lowest, highest) = ends_of(scores.iter().map(|(_, score)| *score));
    let highest = highest.max(0.0);
    let best = numbered(|trial| trial.best_so_far);
    let mut series = vec![
        Series::new("each point", SeriesKind::Dots, scores).colour(4),
        Series::new("best so far", SeriesKind::Steps, best).colour(1),
    ];
    let design = trials.iter().take_while(|trial| trial.is_design).count();
    if design > 0 {
        let x = design as f64 + 0.5;
        let label = "end of the space-filling first design";
        let ends = vec![(x, lowest), (x, highest)];
        series.push(Series::new(label, SeriesKind::Level, ends));
    }
    Some(LinePlot {
        scale: ScoreScale::Auto,
        ..LinePlot::new(
            Caption::default(),
            AxisSpec::new("points evaluated", Unit::One),
            score.pair(),
            series,
        )
    })
}

/// A point's simulated path with its score and the first two of its values.
pub(crate) fn panel(
    names: &[&str],
    values: &[f64],
    score: Option<f64>,
    path_m: &[PathPoint],
    is_best: bool,
) -> Panel {
    let shown = names.iter().zip(values).take(2);
    let note = shown.map(|(name, value)| {
        let name = name.rsplit('.').next().unwrap_or_default();
        format!("{name} {}", short(*value))
    });
    let note: Vec<String> = note.collect();
    let path = (!path_m.is_empty()).then(|| path_m.to_vec());
    Panel {
        score,
        note: note.join(", "),
        simulated_m: path.into_iter().collect(),
        is_best,
    }
}

/// A number as short as it can be written without losing the grid: up to four decimals.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::Point;
    use super::*;

    fn point(values: [f64; 2], score: Option<f64>, is_in: bool) -> Point {
        Point {
            values: values.to_vec(),
            score,
            is_indistinguishable: is_in,
            ..Point::default()
        }
    }

    #[test]
    fn a_grid_of_two_parameters_is_a_heat_map_and_nothing_else_is() {
        let on_grid = (0..6).map(|k| {
            let values = [f64::from(k % 3), f64::from(k / 3)];
            point(values, (k != 4).then_some(f64::from(k) + 1.0), k < 2)
        });
        let mut points = Points {
            names: vec!["a".to_owned(), "b".to_owned()],
            points: on_grid.collect(),
        };
        // A point between those of the grid, in the cell of the last one: it does not outline a cell whose own point is told apart.
        points.points.push(point([1.8, 0.9], Some(0.5), true));
        let score = ScoreName::of_report("pca", "m");
        let axes = complete_grid(&points, 6).unwrap();
        let map = heat_map(&points, axes, 6, Some(6), &[vec![0.1, 1.0]], &score);
        assert_eq!(map.scores[4], None);
        assert_eq!(map.table_rows, (0..6).map(Some).collect::<Vec<_>>());
        let in_set = [true, true, false, true, false, false];
        assert_eq!(map.indistinguishable, in_set);
        assert_eq!((map.best, map.best_at), (Some((2, 1)), Some((1.8, 0.9))));
        assert_eq!((map.score_unit, map.best_score), (Unit::Metre, Some(0.5)));
        points.points.remove(0);
        assert!(complete_grid(&points, 5).is_none());
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [short(0.43), short(1.0), short(0.05 + 0.1)],
            ["0.43", "1", "0.15"]
        );
    }
}
