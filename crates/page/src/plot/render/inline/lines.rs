//! Lines, dots and bands inside of a page.

use std::fmt::Write as _;

use super::{Inline, InlineChart, LABEL, axis_names, label, set_width, star, widest};
use crate::markup::html;
use crate::plot::chart::series::{finite_points, is_finite, stepped};
use crate::plot::kit::*;
use crate::plot::{LinePlot, Series, SeriesKind};
use realgap_core::statistics::ends_of;

/// Size of a chart in its own units; the page scales it.
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 258.0;
/// Least room at the sides; wider numbers get more.
const LEFT: f64 = 52.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 52.0;

/// Classes of the colours of series, by their number.
const CLASSES: [&str; 6] = ["sim", "b1", "b2", "b3", "b4", "b5"];

/// From values to places.
#[derive(Debug, Clone, Copy)]
struct Places {
    x: Scale,
    y: Scale,
    left: f64,
    right: f64,
}

impl Places {
    fn at_x(&self, value: f64) -> f64 {
        self.left + self.x.share(value) * (self.right - self.left)
    }

    /// The height of a value, at an end of the frame where the value lies beyond.
    fn at_y(&self, value: f64) -> f64 {
        HEIGHT - BOTTOM - self.y.share(value).clamp(0.0, 1.0) * (HEIGHT - TOP - BOTTOM)
    }

    fn at(&self, (x, y): Point) -> Point {
        (self.at_x(x), self.at_y(y))
    }

    fn x_ticks(&self, plot: &LinePlot) -> Vec<Tick> {
        plot.x_ticks(&self.x, 5)
    }
}

fn is_map(plot: &LinePlot) -> bool {
    plot.scale == ScoreScale::LikeX
}

fn places(plot: &LinePlot) -> Places {
    let range = |values: &mut dyn Iterator<Item = f64>| match ends_of(values) {
        (low, high) if low <= high => [low, high],
        _ => [0.0, 1e-3],
    };
    let mut places = Places {
        x: plot.x_scale(),
        y: plot.y_scale(1.0),
        left: LEFT,
        right: WIDTH - RIGHT,
    };
    let x = range(&mut finite_points(&plot.series).map(|(x, _)| x));
    let y = range(&mut finite_points(&plot.series).map(|(_, y)| y));
    // The widths of the numbers decide how much room they need, and the room of a map decides its numbers: the scripts
    // (`chart.js`) do the same.
    for _ in 0..3 {
        if is_map(plot) {
            let (wide, high) = (places.right - places.left, HEIGHT - TOP - BOTTOM);
            let scale = 1.08 * ((x[1] - x[0]) / wide).max((y[1] - y[0]) / high);
            let around = |range: [f64; 2], length: f64| {
                let middle = 0.5 * (range[0] + range[1]);
                let half = 0.5 * scale * length;
                Scale::linear(middle - half, middle + half)
            };
            (places.x, places.y) = (around(x, wide), around(y, high));
        }
        let beside = LABEL + widest(&places.y.ticks(5));
        let beyond = 1.0 + 0.5 * widest(&places.x_ticks(plot));
        places.left = places.left.max(beside).round();
        places.right = places.right.min(WIDTH - beyond).round();
    }
    places
}

/// The class of a series: recordings have one colour everywhere.
fn class(series: &Series) -> &'static str {
    match series.kind {
        SeriesKind::Level => "edge",
        _ if series.is_recorded => "real",
        _ => CLASSES[series.colour % CLASSES.len()],
    }
}

impl InlineChart for LinePlot {
    fn inline(&self, inline: &Inline<'_>) -> String {
        let unit = self.inline_unit();
        in_unit(self, unit).drawn_inline(
            inline,
            [if is_map(self) { unit.factor } else { 1.0 }, unit.factor],
        )
    }
}

impl LinePlot {
    /// The unit in which the vertical values read well, and both coordinates of a map.
    fn inline_unit(&self) -> DisplayUnit {
        match is_map(self) {
            false => self.display_unit(),
            true => {
                let both = finite_points(&self.series).flat_map(|(x, y)| [x, y]);
                let largest = both.fold(0.0, |largest: f64, value| largest.max(value.abs()));
                DisplayUnit::for_size(self.y_unit, largest)
            }
        }
    }
}

/// The same chart with vertical values, and both coordinates of a map, in this unit: 0.004 rad becomes 4 mrad. Scripts that draw it
/// again multiply the stored values by the factors in `data-factor`.
fn in_unit(plot: &LinePlot, unit: DisplayUnit) -> LinePlot {
    let scaled = |value: f64| value * unit.factor;
    let mut plot = plot.clone();
    let is_map = is_map(&plot);
    for series in &mut plot.series {
        for point in &mut series.points {
            point.1 = scaled(point.1);
            if is_map {
                point.0 = scaled(point.0);
            }
        }
        if let SeriesKind::Band(high) = &mut series.kind {
            high.iter_mut().for_each(|value| *value = scaled(*value));
        }
    }
    if let Some(best) = &mut plot.best {
        best.score = best.score.map(scaled);
    }
    plot.y_range = plot.y_range.map(|(low, high)| (scaled(low), scaled(high)));
    plot.y_label = unit.label(&plot.y_label);
    plot.y_unit = Unit::One;
    if is_map {
        plot.x = AxisSpec::new(unit.label(&plot.x.label), Unit::One);
    }
    plot
}

impl LinePlot {
    fn drawn_inline(&self, inline: &Inline<'_>, factors: [f64; 2]) -> String {
        let places = places(self);
        let kind = match self.x.unit {
            _ if is_map(self) => "map",
            Unit::Second => "time",
            _ if inline.follows_time => "time",
            _ => "plain",
        };
        let (left, right, bottom) = (places.left, places.right, HEIGHT - BOTTOM);
        let mut svg = format!(
            "<svg {}class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\" data-chart=\"{kind}\" \
             data-x=\"{} {}\" data-y=\"{} {}\" data-factor=\"{} {}\" data-box=\"{left} {TOP} {right} {bottom}\">",
            inline.id_attribute(),
            html(inline.alt),
            places.x.low,
            places.x.high,
            places.y.low,
            places.y.high,
            factors[0],
            factors[1],
        );
        svg += &set(self, &places);
        svg += &axes(self, &places);
        svg += &marks_below(self, &places);
        for series in &self.series {
            svg += &drawn(series, &places);
        }
        if let Some((x, score)) = self.best.and_then(|best| Some((best.x, best.score?))) {
            svg += &star(places.at((x, score)));
        }
        svg.push_str("</svg>");
        svg
    }
}

/// Shaded cells of the values that cannot be told from the best.
fn set(plot: &LinePlot, places: &Places) -> String {
    let Some(grid) = &plot.grid else {
        return String::new();
    };
    let edges = edges(&grid.values);
    let marked = grid.indistinguishable.iter().zip(edges.windows(2));
    let cells = marked.filter(|(is_in, _)| **is_in).map(|(_, ends)| {
        let [from, to] = [ends[0], ends[1]].map(|edge| places.at_x(edge));
        let (wide, tall) = (to - from, HEIGHT - BOTTOM - TOP);
        format!("<rect class=\"set\" x=\"{from:.1}\" y=\"{TOP}\" width=\"{wide:.1}\" height=\"{tall}\"/>")
    });
    cells.collect()
}

/// Grid lines, numbers and the names of both axes.
fn axes(plot: &LinePlot, places: &Places) -> String {
    let mut svg = String::new();
    let (left, right, bottom) = (places.left, places.right, HEIGHT - BOTTOM);
    let mut free_from = f64::NEG_INFINITY;
    for tick in places.x_ticks(plot) {
        let (x, text) = (places.at_x(tick.value), label(&tick));
        let _infallible = write!(
            svg,
            "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{bottom:.1}\"/>"
        );
        // Of numbers that would touch each other the later one is left out.
        let half = 0.5 * set_width(&text);
        if x - half > free_from {
            free_from = x + half + 4.0;
            let baseline = bottom + 22.0;
            let _infallible = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{baseline:.1}\" text-anchor=\"middle\">{text}</text>"
            );
        }
    }
    for tick in places.y.ticks(5) {
        let (y, text) = (places.at_y(tick.value), label(&tick));
        let (beside, baseline) = (left - 6.0, y + 4.0);
        let _infallible = write!(
            svg,
            "<line class=\"grid\" x1=\"{left:.1}\" x2=\"{right:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>\
             <text x=\"{beside:.1}\" y=\"{baseline:.1}\" text-anchor=\"end\">{text}</text>"
        );
    }
    let middle = 0.5 * (left + right);
    let y = DisplayUnit::for_size(plot.y_unit, f64::INFINITY).label(&plot.y_label);
    svg + &axis_names(
        [&plot.x.title(), &(y + &places.y.remark())],
        (middle, HEIGHT - 7.0, 2.0 * middle.min(WIDTH - middle)),
        (0.5 * (TOP + bottom), bottom),
    )
}

/// The true value as a line, and crosses at the top where a simulation diverged.
fn marks_below(plot: &LinePlot, places: &Places) -> String {
    let mut svg = String::new();
    let is_inside = |x: &f64| (0.0..=1.0).contains(&places.x.share(*x));
    for x in plot.truth.iter().map(|truth| truth.x).filter(is_inside) {
        let (x, bottom) = (places.at_x(x), HEIGHT - BOTTOM);
        let _infallible = write!(
            svg,
            "<path class=\"line edge\" d=\"M{x:.1} {TOP}L{x:.1} {bottom}\"/>"
        );
    }
    if let Some(grid) = &plot.grid {
        let diverged = grid.values.iter().zip(&grid.diverged);
        for (value, _) in diverged.filter(|(_, is_diverged)| **is_diverged) {
            let (x, y) = (places.at_x(*value), TOP + 5.0);
            let _infallible = write!(
                svg,
                "<path class=\"line faint\" d=\"M{:.1} {:.1}l6 6m0 -6l-6 6\"/>",
                x - 3.0,
                y - 3.0
            );
        }
    }
    svg
}

fn drawn(series: &Series, places: &Places) -> String {
    let class = class(series);
    match &series.kind {
        SeriesKind::Band(other) => {
            let pairs = series.points.iter().copied().zip(other.iter().copied());
            let pairs = pairs.filter(|(point, y)| is_finite(point) && y.is_finite());
            let pairs: Vec<(Point, f64)> = pairs.collect();
            if pairs.is_empty() {
                return String::new();
            }
            let edge = pairs.iter().map(|(point, _)| *point);
            let back = pairs.iter().rev().map(|((x, _), y)| (*x, *y));
            let outline: Vec<Point> = edge.chain(back).collect();
            format!("<path class=\"band\" d=\"{}Z\"/>", path(places, &outline))
        }
        SeriesKind::Dots => {
            let points = series.points.iter().filter(|point| is_finite(point));
            let dots = points.map(|point| {
                let (x, y) = places.at(*point);
                format!("<circle class=\"mark {class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>")
            });
            dots.collect()
        }
        kind => {
            let runs = series.points.split(|point| !is_finite(point));
            let runs = runs.map(|run| match kind {
                SeriesKind::Steps => path(places, &stepped(run)),
                _ => path(places, run),
            });
            let dashed = if *kind == SeriesKind::Dashed {
                " dashed"
            } else {
                ""
            };
            let d: String = runs.collect();
            format!("<path class=\"line {class}{dashed}\" d=\"{d}\"/>")
        }
    }
}

/// A path through the points, to a tenth of a unit; points that would not be seen apart are one.
fn path(places: &Places, points: &[Point]) -> String {
    let mut text = String::new();
    let mut last = String::new();
    for (x, y) in points.iter().map(|point| places.at(*point)) {
        let place = format!("{x:.1} {y:.1}");
        if place != last {
            let _infallible = write!(text, "{}{place}", if text.is_empty() { "M" } else { "L" });
            last = place;
        }
    }
    text
}

/// The legend as an element: what the marks and the series that have a label are; empty where none has.
pub(crate) fn legend(plot: &LinePlot) -> String {
    let unit = plot.display_unit();
    let mut keys = Vec::new();
    for series in plot.series.iter().filter(|series| !series.label.is_empty()) {
        let kind = match series.kind {
            SeriesKind::Band(_) => "band".to_owned(),
            SeriesKind::Dots => format!("mark {}", class(series)),
            SeriesKind::Dashed => format!("dashed {}", class(series)),
            _ => class(series).to_owned(),
        };
        keys.push(format!(
            "<span><i class=\"key {kind}\"></i>{}</span>",
            html(&series.label)
        ));
    }
    for (symbol, text) in plot.legend(unit) {
        let mark = match symbol {
            Symbol::Star => "★ ",
            Symbol::Cross => "× ",
            Symbol::Shade(colour) if colour == SHADE => "<i class=\"key set\"></i>",
            _ => continue,
        };
        keys.push(format!("<span>{mark}{}</span>", html(&text)));
    }
    if let Some(truth) = &plot.truth {
        let text = format!("{}: {}", truth.label, plot.x.at(truth.x));
        keys.push(format!(
            "<span><i class=\"key edge\"></i>{}</span>",
            html(&text)
        ));
    }
    match keys.is_empty() {
        true => String::new(),
        false => format!("<div class=\"legend\">{}</div>", keys.concat()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{BestPoint, Truth};

    #[test]
    fn a_chart_of_nothing_is_still_a_chart_and_names_are_no_markup() {
        let band = Series::new("<b>", SeriesKind::Band(Vec::new()), Vec::new());
        let plot = LinePlot::new(
            Caption::default(),
            AxisSpec::new("\"><script>", Unit::One),
            ("<i>", Unit::One),
            vec![band],
        );
        let svg = plot.inline(&Inline::new("\"><script>"));
        let foreign = ["<script", "\"Z\"", "NaN", "inf", "<i>"];
        assert!(foreign.iter().all(|text| !svg.contains(text)), "{svg}");
        roxmltree::Document::parse(&svg).unwrap();
        assert!(!legend(&plot).contains("<b>"));
    }

    #[test]
    fn a_score_over_a_parameter_shows_its_set_its_best_and_its_truth() {
        let scores = [Some(3.0), Some(1.0), Some(1.1), None];
        let set = vec![false, true, true, false];
        let values = vec![0.1, 0.2, 0.3, 0.4];
        let mut plot = LinePlot::over_parameter(
            Caption::default(),
            AxisSpec::new("friction", Unit::One),
            ("rms", Unit::Metre),
            values,
            &scores,
            set,
        );
        plot.best = Some(BestPoint {
            x: 0.2,
            score: Some(1.0),
        });
        plot.truth = Some(Truth {
            x: 0.21,
            y: 0.0,
            label: "hidden value".to_owned(),
        });
        let svg = plot.inline(&Inline::new("Score over friction"));
        assert_eq!(svg.matches("class=\"set\"").count(), 2);
        for mark in ["star", "line edge", "line faint", "rms (m)", "friction"] {
            assert!(svg.contains(mark), "{mark}: {svg}");
        }
        roxmltree::Document::parse(&svg).unwrap();
        let keys = legend(&plot);
        for text in [
            "best: 1.00 m",
            "95 % confidence set",
            "hidden value",
            "diverged (1)",
        ] {
            assert!(keys.contains(text), "{text}: {keys}");
        }
    }
}
