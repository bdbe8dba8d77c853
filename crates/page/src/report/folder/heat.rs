//! A heat map as SVG inside of a page: a cell a point, its values on hover, a frame around what cannot be told from the best.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::plot::{Scale, score_hex as colour};
use crate::report::document::page::html;
use crate::report::folder::chart::{LABEL, set_width};
use realgap_core::statistics::ends_of;
use realgap_core::unit::{DisplayUnit, Unit, number};

/// A point of a sweep.
#[derive(Debug, Clone)]
pub(in crate::report) struct Point {
    /// Values of the parameters, in order.
    pub values: Vec<f64>,
    /// Its score; `None` where it diverged.
    pub score: Option<f64>,
    /// Whether it cannot be told apart from the best.
    pub is_in: bool,
}

/// Where the map is in its picture, and its size.
const TOP: f64 = 12.0;
const WIDE: f64 = 400.0;
const TALL: f64 = 320.0;
/// Room below the map for numbers and a name.
const BELOW: f64 = 48.0;
/// The colour bar: its width, its steps, and what it and its numbers are apart from their neighbours.
const BAR: f64 = 14.0;
const STEPS: u32 = 32;
const GAP: f64 = 16.0;

/// The values that a parameter takes, in order.
fn values(points: &[Point], parameter: usize) -> Vec<f64> {
    let mut all: Vec<f64> = points.iter().map(|p| p.values[parameter]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Points that are a grid of two parameters.
struct Grid<'a> {
    points: &'a [Point],
    /// Points between those of the grid.
    between: &'a [Point],
    names: [String; 2],
    /// What the score is, and its unit.
    score: [&'a str; 2],
    x_values: Vec<f64>,
    y_values: Vec<f64>,
    low: f64,
    high: f64,
    /// Where the cells begin, behind the numbers of the upright axis.
    left: f64,
}

/// The map of the first two parameters; `None` where the first `count` points are no grid of two. The others, and `best`, may lie between them.
pub(in crate::report) fn heat_map(
    points: &[Point],
    count: usize,
    best: Option<&[f64]>,
    names: &[String],
    score: [&str; 2],
) -> Option<String> {
    let (points, between) = points.split_at(count.min(points.len()));
    if names.len() != 2 || points.is_empty() {
        return None;
    }
    let (x_values, y_values) = (values(points, 0), values(points, 1));
    let (columns, rows) = (x_values.len(), y_values.len());
    if columns * rows != points.len() || columns > 200 || rows > 200 {
        return None;
    }
    let (low, high) = ends_of(points.iter().filter_map(|point| point.score));
    let grid = Grid {
        points,
        between,
        names: [html(&names[0]), html(&names[1])],
        score,
        left: LABEL + widest(y_values.iter().map(|value| number(*value))),
        x_values,
        y_values,
        low,
        high,
    };
    let [x, y] = &grid.names;
    let (cells, axes, (bar, wide)) = (grid.cells(best), grid.axes(), grid.bar());
    let tall = TOP + TALL + BELOW;
    Some(format!(
        "<svg class=\"chart heat\" id=\"heat\" viewBox=\"0 0 {wide:.0} {tall:.0}\" role=\"img\" tabindex=\"0\" aria-label=\"Score over {x} and {y}; the same numbers are in the table of points\">{cells}{axes}{bar}</svg>"
    ))
}

/// The width of the widest of these numbers.
fn widest(texts: impl Iterator<Item = String>) -> f64 {
    texts.map(|text| set_width(&text)).fold(0.0, f64::max)
}

impl Grid<'_> {
    /// Sides of a cell.
    fn cell(&self) -> [f64; 2] {
        let (columns, rows) = (self.x_values.len(), self.y_values.len());
        [WIDE / columns as f64, TALL / rows as f64]
    }

    /// The cells with what they stand for, and above them the frames.
    fn cells(&self, best: Option<&[f64]>) -> String {
        let [wide, tall] = self.cell();
        // In cells from the first, between two of them as well.
        let place = |all: &[f64], value: f64| {
            let after = all.iter().position(|v| *v >= value);
            match after.unwrap_or(all.len() - 1) {
                0 => 0.0,
                after => {
                    let step = all[after] - all[after - 1];
                    after as f64 - (all[after] - value) / step
                }
            }
        };
        let corner = |values: &[f64]| {
            let x = self.left + place(&self.x_values, values[0]) * wide;
            let y = TOP + TALL - (place(&self.y_values, values[1]) + 1.0) * tall;
            (x, y)
        };
        let frame = |values: &[f64], class: &str| {
            let (x, y) = corner(values);
            let (x, y) = (x + 1.5, y + 1.5);
            let [wide, tall] = [wide, tall].map(|side| (side - 3.0).max(1.0));
            format!(
                "<rect class=\"frame {class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\"/>"
            )
        };
        // A cell that holds a point that fits as well is framed, like in the picture.
        let cell_of = |point: &Point| {
            let [x, y] = [(&self.x_values, 0), (&self.y_values, 1)]
                .map(|(all, axis)| place(all, point.values[axis]).round());
            (x as usize, y as usize)
        };
        let all = self.points.iter().chain(self.between);
        let alike: BTreeSet<_> = all.filter(|point| point.is_in).map(cell_of).collect();
        let (mut cells, mut frames) = (String::new(), String::new());
        for (index, point) in self.points.iter().enumerate() {
            let (x, y) = corner(&point.values);
            let (class, fill, shown) = match point.score {
                Some(score) => {
                    let share = (score - self.low) / (self.high - self.low).max(f64::MIN_POSITIVE);
                    let shown = format!("{} {}", number(score), self.score[1]);
                    ("cell", colour(share), html(&shown))
                }
                None => ("cell lost", "#888888".to_owned(), "diverged".to_owned()),
            };
            let is_framed = alike.contains(&cell_of(point));
            let alike = match (is_framed, point.is_in) {
                (_, true) => ", cannot be told from the best",
                (true, _) => "; beside it are points that cannot be told from the best",
                _ => "",
            };
            let [x_name, y_name] = &self.names;
            let [x_value, y_value] = [0, 1].map(|axis| number(point.values[axis]));
            let _infallible = write!(
                cells,
                "<rect class=\"{class}\" data-point=\"{index}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\" fill=\"{fill}\"><title>{x_name} = {x_value}, {y_name} = {y_value}: {shown}{alike}</title></rect>",
            );
            if is_framed {
                frames += &frame(&point.values, "in");
            }
        }
        frames += &best.map_or_else(String::new, |best| frame(best, "best"));
        cells + &frames
    }

    /// Values and names along both sides.
    fn axes(&self) -> String {
        let [wide, tall] = self.cell();
        let below = |k: f64| (self.left + k * wide, TOP + TALL + 18.0, "middle");
        let beside = |k: f64| (self.left - 6.0, TOP + TALL - k * tall + 4.0, "end");
        let texts = |all: &[f64], at: &dyn Fn(f64) -> (f64, f64, &'static str)| -> String {
            let some = all.iter().enumerate().step_by(all.len().div_ceil(6));
            some.map(|(index, value)| {
                let (x, y, anchor) = at(index as f64 + 0.5);
                let value = number(*value);
                format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{value}</text>")
            })
            .collect()
        };
        let [x, y] = &self.names;
        let (middle, low) = (self.left + 0.5 * WIDE, TOP + TALL + 40.0);
        let up = TOP + 0.5 * TALL;
        let along = texts(&self.x_values, &below) + &texts(&self.y_values, &beside);
        format!(
            "{along}<text class=\"axis\" x=\"{middle:.1}\" y=\"{low:.1}\" text-anchor=\"middle\">{x}</text><text class=\"axis\" transform=\"translate(11 {up:.1}) rotate(-90)\" text-anchor=\"middle\">{y}</text>",
        )
    }

    /// What colours mean, and where the picture ends behind it.
    fn bar(&self) -> (String, f64) {
        let left = self.left + WIDE + GAP;
        let height = TALL / f64::from(STEPS);
        let steps = (0..STEPS).map(|step| {
            let (y, tall) = (TOP + height * f64::from(step), height + 0.5);
            let fill = colour(1.0 - f64::from(step) / f64::from(STEPS - 1));
            format!(
                "<rect x=\"{left:.1}\" y=\"{y:.1}\" width=\"{BAR}\" height=\"{tall:.1}\" fill=\"{fill}\"/>"
            )
        });
        let [metric, unit] = self.score;
        // Metres are shown in a unit of handy size, as everywhere; whatever else it is keeps its name.
        let (factor, unit) = match unit {
            "m" => {
                let scores = self.points.iter().filter_map(|point| point.score);
                let shown = DisplayUnit::for_values(Unit::Metre, scores);
                (shown.factor, shown.symbol)
            }
            other => (1.0, other),
        };
        let name = match unit {
            "" | "1" => html(metric),
            unit => html(&format!("{metric} [{unit}]")),
        };
        let (low, high) = (self.low * factor, self.high * factor);
        let ticks = match low <= high {
            true => Scale::linear(low, high).ticks(5),
            false => Vec::new(),
        };
        let beside = left + BAR + 6.0;
        let said = ticks.iter().map(|tick| {
            let share = (tick.value - low) / (high - low).max(f64::MIN_POSITIVE);
            // Scores that are all the same have the middle of the bar.
            let share = if high > low { share } else { 0.5 };
            let y = TOP + (1.0 - share) * TALL + 4.0;
            format!("<text x=\"{beside:.1}\" y=\"{y:.1}\">{}</text>", tick.label)
        });
        let name_x = beside + widest(ticks.iter().map(|tick| tick.label.clone())) + 16.0;
        let up = TOP + 0.5 * TALL;
        let name = format!(
            "<text class=\"axis\" transform=\"translate({name_x:.1} {up:.1}) rotate(-90)\" text-anchor=\"middle\">{name}</text>"
        );
        let all = steps.chain(said).chain([name]).collect();
        (all, name_x + 6.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_a_cell_and_the_best_a_frame() {
        let mut points: Vec<Point> = (0..6)
            .map(|k| Point {
                values: vec![f64::from(k % 3), f64::from(k / 3)],
                score: (k != 4).then_some(f64::from(k) + 1.0),
                is_in: k < 2,
            })
            .collect();
        let names = ["a<b".to_owned(), "c".to_owned()];
        // One that lies in the cell of the last, which is not as good itself.
        points.push(Point {
            values: vec![1.8, 0.9],
            score: Some(1.5),
            is_in: true,
        });
        let svg = heat_map(&points, 6, Some(&[0.5, 1.0]), &names, ["pca", "m"]).unwrap();
        assert_eq!(svg.matches("frame in").count(), 3);
        assert_eq!(svg.matches("data-point=").count(), 6);
        assert_eq!(svg.matches("frame best").count(), 1);
        assert_eq!(svg.matches("cell lost").count(), 1);
        assert!(!svg.contains("a<b") && svg.contains(&colour(0.0)));
        roxmltree::Document::parse(&svg).unwrap();
        // Scores from 1 m to 6 m: what they are stands beside round numbers.
        for said in ["pca [m]", ">2</text>", ">6</text>"] {
            assert!(svg.contains(said), "{said}");
        }
        assert!(
            heat_map(&points[1..], 5, None, &names, ["pca", "m"]).is_none(),
            "no grid"
        );
    }
}
