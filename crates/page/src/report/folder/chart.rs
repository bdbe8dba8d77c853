//! Charts as SVG inside of a page: readable without scripts, in both themes, on paper.
//!
//! Colours are classes (`sim`, `real`, `band`), which the style sheet fills in; where the scripts find the attribute
//! `data-chart="time"` they add a cursor that moves with the replay.

use std::fmt::Write as _;

use crate::plot::Scale;
use crate::report::document::page::html;
use crate::report::document::section::figure;

/// Size of a chart in its own units; the page scales it.
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 250.0;
/// Least room at the sides; wider numbers get more.
const LEFT: f64 = 52.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 44.0;
/// What the name of the upright axis takes, with the gaps beside it and the numbers.
pub(in crate::report) const LABEL: f64 = 22.0;

/// A line of a chart.
#[derive(Debug)]
pub(in crate::report) struct Line {
    /// Class of its colour.
    pub class: &'static str,
    /// Points.
    pub points: Vec<[f64; 2]>,
}

/// What the axes of a chart are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::report) enum Axes {
    /// Something over time: a cursor follows the replay.
    #[default]
    Time,
    /// A path seen from above, one scale for both axes: dots follow the replay.
    Map,
    /// Something over anything else.
    Plain,
}

/// A chart of lines over two axes.
#[derive(Debug, Default)]
pub(in crate::report) struct Chart {
    /// Said to who does not see it.
    pub alt: String,
    /// With units.
    pub x_label: String,
    /// With units.
    pub y_label: String,
    /// What they are.
    pub axes: Axes,
    /// Whether the upright axis begins at 0, or lower where numbers are.
    pub from_zero: bool,
    /// Lower and upper end at each x, the widest first.
    pub bands: Vec<Vec<[f64; 3]>>,
    /// Lines, the first below all others.
    pub lines: Vec<Line>,
    /// Marks of single points above all lines.
    pub dots: Vec<Line>,
}

/// From numbers to places.
#[derive(Debug, Clone, Copy)]
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    left: f64,
    right: f64,
}

impl Frame {
    fn place(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        (
            self.left + share(x, self.x) * (self.right - self.left),
            HEIGHT - BOTTOM - share(y, self.y) * (HEIGHT - TOP - BOTTOM),
        )
    }
}

impl Chart {
    /// Something over anything else.
    pub fn plain(alt: impl Into<String>, x_label: &str, y_label: impl Into<String>) -> Self {
        Self {
            alt: alt.into(),
            x_label: x_label.to_owned(),
            y_label: y_label.into(),
            axes: Axes::Plain,
            ..Self::default()
        }
    }

    /// Something over time.
    pub fn over_time(alt: impl Into<String>, y_label: impl Into<String>) -> Self {
        let mut chart = Self::plain(alt, "time [s]", y_label);
        chart.axes = Axes::Time;
        chart
    }

    /// Paths seen from above.
    pub fn map(alt: &str) -> Self {
        let mut chart = Self::plain(alt, "x [m]", "y [m]");
        chart.axes = Axes::Map;
        chart
    }

    /// The same with the upright axis from 0.
    pub fn upwards(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// The same with a line above the others.
    pub fn line(mut self, class: &'static str, points: Vec<[f64; 2]>) -> Self {
        self.lines.push(Line { class, points });
        self
    }

    /// The same with lines of one kind above the others.
    pub fn lines(self, class: &'static str, all: impl Iterator<Item = Vec<[f64; 2]>>) -> Self {
        all.fold(self, |chart, points| chart.line(class, points))
    }

    /// The same with a band within the others.
    pub fn band(mut self, band: Vec<[f64; 3]>) -> Self {
        self.bands.push(band);
        self
    }

    /// The same with marks.
    pub fn dots(mut self, class: &'static str, points: Vec<[f64; 2]>) -> Self {
        self.dots.push(Line { class, points });
        self
    }

    /// The chart with a title, and what it says.
    pub fn figure(&self, title: &str, caption: &str) -> String {
        figure(title, &self.svg(), caption)
    }

    fn frame(&self) -> Frame {
        let band = self.bands.iter().flatten();
        let banded = band.flat_map(|[x, low, high]| [[*x, *low], [*x, *high]]);
        let drawn = self.lines.iter().chain(&self.dots);
        let points = drawn.flat_map(|line| &line.points).copied();
        let [mut x, mut y] = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let is_map = self.axes == Axes::Map;
        if self.from_zero && !is_map {
            y = [0.0, 0.0];
        }
        for point in points.chain(banded) {
            for (range, value) in [(&mut x, point[0]), (&mut y, point[1])] {
                if value.is_finite() {
                    *range = [range[0].min(value), range[1].max(value)];
                }
            }
        }
        for range in [&mut x, &mut y] {
            if range[1] - range[0] < 1e-9 || !(range[1] - range[0]).is_finite() {
                let middle = if range[0].is_finite() { range[0] } else { 0.0 };
                *range = [middle, middle + 1e-3];
            }
        }
        if !is_map {
            let room = 0.06 * (y[1] - y[0]);
            y[1] += room;
            if y[0] != 0.0 {
                y[0] -= room;
            }
        }
        let (left, right) = (LEFT, WIDTH - RIGHT);
        let mut frame = Frame { x, y, left, right };
        // Numbers decide how much room they need, and of a map the room which numbers there are: as report/page/chart.js.
        for _ in 0..3 {
            if is_map {
                let (wide, high) = (frame.right - frame.left, HEIGHT - TOP - BOTTOM);
                let scale = 1.08 * ((x[1] - x[0]) / wide).max((y[1] - y[0]) / high);
                let around = |range: [f64; 2], length: f64| {
                    let middle = 0.5 * (range[0] + range[1]);
                    [middle - 0.5 * scale * length, middle + 0.5 * scale * length]
                };
                (frame.x, frame.y) = (around(x, wide), around(y, high));
            }
            let widest = |range| {
                let ticks = ticks(range).into_iter();
                ticks.map(|(_, text)| set_width(&text)).fold(0.0, f64::max)
            };
            frame.left = frame.left.max(LABEL + widest(frame.y)).round();
            frame.right = frame.right.min(WIDTH - 1.0 - 0.5 * widest(frame.x)).round();
        }
        frame
    }

    /// The chart as an `svg` element.
    pub fn svg(&self) -> String {
        let frame = self.frame();
        let [low, high] = [0, 1].map(|end| frame.place([frame.x[end], frame.y[end]]));
        let kind = match self.axes {
            Axes::Time => "time",
            Axes::Map => "map",
            Axes::Plain => "plain",
        };
        let ([x0, x1], [y0, y1]) = (frame.x, frame.y);
        let mut svg = format!(
            "<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\" data-chart=\"{kind}\" \
             data-x=\"{} {}\" data-y=\"{} {}\" data-box=\"{} {} {} {}\">",
            html(&self.alt),
            x0,
            x1,
            y0,
            y1,
            low.0,
            high.1,
            high.0,
            low.1,
        );
        for (value, text) in ticks(frame.x) {
            let (x, _) = frame.place([value, frame.y[0]]);
            let _infallible = write!(
                svg,
                "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{:.1}\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                low.1,
                low.1 + 18.0,
                text,
            );
        }
        for (value, text) in ticks(frame.y) {
            let (_, y) = frame.place([frame.x[0], value]);
            let _infallible = write!(
                svg,
                "<line class=\"grid\" x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                low.0,
                high.0,
                low.0 - 6.0,
                y + 4.0,
                text,
            );
        }
        let middle = 0.5 * (low.0 + high.0);
        let _infallible = write!(
            svg,
            "<text class=\"axis\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
             <text class=\"axis\" transform=\"translate(11 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            middle,
            HEIGHT - 7.0,
            html(&short(&self.x_label, 2.0 * middle.min(WIDTH - middle))),
            0.5 * (low.1 + high.1),
            html(&short(&self.y_label, HEIGHT - BOTTOM)),
        );
        for band in self.bands.iter().filter(|band| !band.is_empty()) {
            let upper = band.iter().map(|[x, _, high]| [*x, *high]);
            let lower = band.iter().rev().map(|[x, low, _]| [*x, *low]);
            let points = path(&frame, upper.chain(lower));
            let _infallible = write!(svg, "<path class=\"band\" d=\"{points}Z\"/>");
        }
        for line in &self.lines {
            let points = path(&frame, line.points.iter().copied());
            let _infallible = write!(svg, "<path class=\"line {}\" d=\"{points}\"/>", line.class);
        }
        for dots in &self.dots {
            let (class, points) = (dots.class, dots.points.iter());
            for point in points.filter(|p| p[0].is_finite() && p[1].is_finite()) {
                let (x, y) = frame.place(*point);
                svg += &format!(
                    "<circle class=\"mark {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>"
                );
            }
        }
        svg.push_str("</svg>");
        svg
    }
}

/// Values over times, as points.
pub(in crate::report) fn over<'a>(
    times: &[f64],
    values: impl IntoIterator<Item = &'a f64>,
) -> Vec<[f64; 2]> {
    let both = times.iter().zip(values);
    both.map(|(t, v)| [*t, *v]).collect()
}

/// Each value kept until the next.
pub(in crate::report) fn steps(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = Vec::new();
    for [x, y] in points {
        all.extend(all.last().map(|[_, before]| [x, *before]));
        all.push([x, y]);
    }
    all
}

/// A name in a legend beside what it stands for.
pub(in crate::report) fn key(class: &str, name: &str) -> String {
    format!("<span><i class=\"key {class}\"></i>{}</span>", html(name))
}

/// A path through the points, to a tenth of a unit; points that would not be seen apart are one.
fn path(frame: &Frame, points: impl Iterator<Item = [f64; 2]>) -> String {
    let mut text = String::new();
    let mut last = String::new();
    for (x, y) in points.map(|point| frame.place(point)) {
        if !(x.is_finite() && y.is_finite()) {
            continue;
        }
        let place = format!("{x:.1} {y:.1}");
        if place != last {
            let _infallible = write!(text, "{}{place}", if text.is_empty() { "M" } else { "L" });
            last = place;
        }
    }
    text
}

/// The greatest width of a number in 12 units, whatever font the reader has.
pub(in crate::report) fn set_width(text: &str) -> f64 {
    let wide = |c: char| if ".,-−".contains(c) { 4.5 } else { 7.7 };
    text.chars().map(wide).sum()
}

/// A name that has this much room, cut where it is longer.
fn short(name: &str, room: f64) -> String {
    const LETTER: f64 = 7.6;
    let most = (room / LETTER) as usize;
    let kept = name.chars().take(most.saturating_sub(1));
    match name.chars().count() > most {
        true => kept.chain(['…']).collect(),
        false => name.to_owned(),
    }
}

/// Round numbers within the range, and how they are written.
fn ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let ticks = Scale::linear(low, high).ticks(5).into_iter();
    // A hyphen is what screens read as a minus everywhere.
    let ticks = ticks.map(|tick| (tick.value, tick.label.replace('−', "-")));
    ticks.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let (values, _): (Vec<f64>, Vec<String>) = ticks([0.0, 10.0]).into_iter().unzip();
        assert_eq!(values, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        let (_, texts): (Vec<f64>, Vec<String>) = ticks([-0.03, 0.07]).into_iter().unzip();
        assert_eq!(texts, ["-0.02", "0.00", "0.02", "0.04", "0.06"]);
    }

    #[test]
    fn a_chart_of_nothing_is_still_a_chart_and_names_are_no_markup() {
        let chart = Chart {
            alt: "\"><script>".to_owned(),
            bands: vec![Vec::new()],
            ..Chart::default()
        };
        let svg = chart.svg();
        assert!(
            !svg.contains("<script")
                && !svg.contains("\"Z\"")
                && !svg.contains("NaN")
                && !svg.contains("inf"),
            "{svg}"
        );
        roxmltree::Document::parse(&svg).unwrap();
    }
}
