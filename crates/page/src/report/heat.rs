//! A heat map as SVG inside of a page: a cell a point, its values on hover, a frame around what cannot be told from the best.

use std::fmt::Write as _;

use super::page::html;
use super::value::measured;
use crate::plot::score_hex as colour;
use realgap_core::unit::number;

/// A point of a sweep.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// Values of the parameters, in order.
    pub values: Vec<f64>,
    /// Its score; `None` where it diverged.
    pub score: Option<f64>,
    /// Whether it cannot be told apart from the best.
    pub is_in: bool,
}

/// Where the map is in its picture, and its size.
const LEFT: f64 = 60.0;
const TOP: f64 = 12.0;
const WIDE: f64 = 440.0;
const TALL: f64 = 340.0;
/// Steps of the colour bar.
const STEPS: u32 = 32;

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
    names: [String; 2],
    unit: &'a str,
    x_values: Vec<f64>,
    y_values: Vec<f64>,
    low: f64,
    high: f64,
}

/// The map of the first two parameters; `None` where the points are no grid of two parameters. `best` may lie between them.
pub(super) fn heat_map(
    points: &[Point],
    best: Option<&[f64]>,
    names: &[String],
    unit: &str,
) -> Option<String> {
    if names.len() != 2 || points.is_empty() {
        return None;
    }
    let (x_values, y_values) = (values(points, 0), values(points, 1));
    let (columns, rows) = (x_values.len(), y_values.len());
    if columns * rows != points.len() || columns > 200 || rows > 200 {
        return None;
    }
    let scores = || points.iter().filter_map(|point| point.score);
    let grid = Grid {
        points,
        names: [html(&names[0]), html(&names[1])],
        unit,
        x_values,
        y_values,
        low: scores().fold(f64::INFINITY, f64::min),
        high: scores().fold(f64::NEG_INFINITY, f64::max),
    };
    let [x, y] = &grid.names;
    let (cells, axes, bar) = (grid.cells(best), grid.axes(), grid.bar());
    Some(format!(
        "<svg class=\"chart heat\" id=\"heat\" viewBox=\"0 0 612 410\" role=\"img\" tabindex=\"0\" aria-label=\"Score over {x} and {y}; the same numbers are in the table of points\">{cells}{axes}{bar}</svg>"
    ))
}

impl Grid<'_> {
    /// Sides of a cell.
    fn cell(&self) -> [f64; 2] {
        [
            WIDE / self.x_values.len() as f64,
            TALL / self.y_values.len() as f64,
        ]
    }

    /// The cells with what they stand for, and above them the frames.
    fn cells(&self, best: Option<&[f64]>) -> String {
        let [wide, tall] = self.cell();
        // In cells from the first, between two of them as well.
        let place = |all: &[f64], value: f64| {
            let after = all
                .iter()
                .position(|v| *v >= value)
                .unwrap_or(all.len() - 1);
            match after {
                0 => 0.0,
                after => {
                    let step = all[after] - all[after - 1];
                    after as f64 - (all[after] - value) / step
                }
            }
        };
        let corner = |values: &[f64]| {
            let x = LEFT + place(&self.x_values, values[0]) * wide;
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
        let (mut cells, mut frames) = (String::new(), String::new());
        for (index, point) in self.points.iter().enumerate() {
            let (x, y) = corner(&point.values);
            let (class, fill, shown) = match point.score {
                Some(score) => {
                    let share = (score - self.low) / (self.high - self.low).max(f64::MIN_POSITIVE);
                    let shown = format!("{} {}", number(score), self.unit);
                    ("cell", colour(share), html(&shown))
                }
                None => ("cell lost", "#888888".to_owned(), "diverged".to_owned()),
            };
            let alike = match point.is_in {
                true => ", cannot be told from the best",
                false => "",
            };
            let [x_name, y_name] = &self.names;
            let [x_value, y_value] = [0, 1].map(|axis| number(point.values[axis]));
            let _infallible = write!(
                cells,
                "<rect class=\"{class}\" data-point=\"{index}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\" fill=\"{fill}\"><title>{x_name} = {x_value}, {y_name} = {y_value}: {shown}{alike}</title></rect>",
            );
            if point.is_in {
                frames += &frame(&point.values, "in");
            }
        }
        frames += &best.map_or_else(String::new, |best| frame(best, "best"));
        cells + &frames
    }

    /// Values and names along both sides.
    fn axes(&self) -> String {
        let [wide, tall] = self.cell();
        let below = |k: f64| (LEFT + k * wide, TOP + TALL + 16.0, "middle");
        let beside = |k: f64| (LEFT - 6.0, TOP + TALL - k * tall + 4.0, "end");
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
        let (middle, low, up) = (LEFT + 0.5 * WIDE, TOP + TALL + 38.0, TOP + 0.5 * TALL);
        let along = texts(&self.x_values, &below) + &texts(&self.y_values, &beside);
        format!(
            "{along}<text class=\"axis\" x=\"{middle:.1}\" y=\"{low:.1}\" text-anchor=\"middle\">{x}</text><text class=\"axis\" transform=\"translate(13 {up:.1}) rotate(-90)\" text-anchor=\"middle\">{y}</text>",
        )
    }

    /// What colours mean.
    fn bar(&self) -> String {
        let height = TALL / f64::from(STEPS);
        let steps = (0..STEPS).map(|step| {
            let (y, tall) = (TOP + height * f64::from(step), height + 0.5);
            let fill = colour(1.0 - f64::from(step) / f64::from(STEPS - 1));
            format!(
                "<rect x=\"516\" y=\"{y:.1}\" width=\"14\" height=\"{tall:.1}\" fill=\"{fill}\"/>"
            )
        });
        let said = [(TOP + 10.0, self.high), (TOP + TALL, self.low)];
        let said = said.map(|(y, score)| {
            let score = html(&measured(Some(score), self.unit));
            format!("<text x=\"535\" y=\"{y:.1}\">{score}</text>")
        });
        steps.chain(said).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_has_a_cell_and_the_best_a_frame() {
        let points: Vec<Point> = (0..6)
            .map(|k| Point {
                values: vec![f64::from(k % 3), f64::from(k / 3)],
                score: (k != 4).then_some(f64::from(k) + 1.0),
                is_in: k < 2,
            })
            .collect();
        let names = ["a<b".to_owned(), "c".to_owned()];
        let svg = heat_map(&points, Some(&[0.5, 1.0]), &names, "m").unwrap();
        assert_eq!(svg.matches("data-point=").count(), 6);
        assert_eq!(svg.matches("frame best").count(), 1);
        assert_eq!(svg.matches("cell lost").count(), 1);
        assert!(!svg.contains("a<b") && svg.contains(&colour(0.0)));
        roxmltree::Document::parse(&svg).unwrap();
        assert!(
            heat_map(&points[1..], None, &names, "m").is_none(),
            "no grid"
        );
    }
}
