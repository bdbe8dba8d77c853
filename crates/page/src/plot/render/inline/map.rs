//! A heat map inside of a page: a cell has its values on hover, and a click on it chooses its point.

use std::fmt::Write as _;

use super::{Inline, InlineChart, LABEL, axis_names, label, set_width, star, widest};
use crate::markup::html;
use crate::plot::HeatMap;
use crate::plot::kit::*;
use realgap_core::unit::number;

/// Where the map is in its element, and its size.
const TOP: f64 = 12.0;
const WIDE: f64 = 400.0;
const TALL: f64 = 320.0;
/// Room below the map for numbers and a name.
const BELOW: f64 = 48.0;
/// The colour bar: its width, its steps, and the gap between it and its neighbours.
const BAR: f64 = 14.0;
const STEPS: u32 = 32;
const GAP: f64 = 16.0;

/// The colour of a share as style sheets write it.
fn hex(RGBColor(r, g, b): RGBColor) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A map with the places of its parts.
struct Layout<'a> {
    map: &'a HeatMap,
    frame: Frame,
    x_ticks: Vec<Tick>,
    y_ticks: Vec<Tick>,
    unit: DisplayUnit,
    scores: Scale,
    has_scores: bool,
}

impl<'a> Layout<'a> {
    fn new(map: &'a HeatMap) -> Self {
        let finite = map.finite_scores();
        let (unit, scores) = map.score_scale(&finite);
        let [x, y] = map.scales();
        let [x_ticks, y_ticks] = map.ticks([&x, &y], [6, 7]);
        let left = (LABEL + widest(&y_ticks)).round();
        let corner = (left + WIDE, TOP + TALL);
        Self {
            map,
            frame: Frame::new((left, TOP), corner, [x, y]),
            x_ticks,
            y_ticks,
            unit,
            scores,
            has_scores: !finite.is_empty(),
        }
    }

    /// The cells with what they stand for.
    fn cells(&self) -> String {
        let (map, frame) = (self.map, &self.frame);
        let xs: Vec<f64> = edges(&map.x_values);
        let ys: Vec<f64> = edges(&map.y_values);
        let names = [&map.x.label, &map.y.label].map(|name| html(name));
        let mut svg = String::new();
        for (iy, y_value) in map.y_values.iter().enumerate() {
            for (ix, x_value) in map.x_values.iter().enumerate() {
                let index = iy * map.x_values.len() + ix;
                let (class, fill, said) = match map.score(ix, iy) {
                    Some(score) => {
                        let share = self.scores.share(score * self.unit.factor);
                        ("cell", hex(map.colour(share)), self.unit.format(score))
                    }
                    None => ("cell lost", "#888888".to_owned(), map.missing.clone()),
                };
                let in_set = match map.is_indistinguishable(ix, iy) {
                    true => ", in the confidence set",
                    false => "",
                };
                let row = map.table_rows.get(index).copied().flatten();
                let row = row.map_or_else(String::new, |row| format!(" data-point=\"{row}\""));
                let (left, top) = (frame.at_x(xs[ix]), frame.at_y(ys[iy + 1]));
                let wide = frame.at_x(xs[ix + 1]) - left;
                let tall = frame.at_y(ys[iy]) - top;
                let [x_name, y_name] = &names;
                let (x_value, y_value) = (number(*x_value), number(*y_value));
                let said = html(&said);
                let _infallible = write!(
                    svg,
                    "<rect class=\"{class}\"{row} x=\"{left:.1}\" y=\"{top:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\" fill=\"{fill}\">\
                     <title>{x_name} = {x_value}, {y_name} = {y_value}: {said}{in_set}</title></rect>",
                );
            }
        }
        svg
    }

    /// The outline of the confidence set, the points that were simulated, the true values and the best point.
    fn marks(&self) -> String {
        let (map, frame) = (self.map, &self.frame);
        let edges = map.boundary().into_iter().map(|(from, to)| {
            let [(x0, y0), (x1, y1)] = [from, to].map(|place| frame.at(place));
            format!("M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}")
        });
        let edges: String = edges.collect();
        let mut svg = String::new();
        if !edges.is_empty() {
            for class in ["outline under", "outline"] {
                let _infallible = write!(svg, "<path class=\"{class}\" d=\"{edges}\"/>");
            }
        }
        for (x, y) in map.evaluated.iter().map(|place| frame.at(*place)) {
            let _infallible = write!(
                svg,
                "<circle class=\"evaluated\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\"/>"
            );
        }
        if let Some(truth) = &map.truth {
            let (x, y) = frame.at((truth.x, truth.y));
            let _infallible = write!(
                svg,
                "<circle class=\"truth\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"11\"/>"
            );
        }
        if let Some((ix, iy)) = map.best {
            svg += &star(frame.at(map.place(ix, iy)));
        }
        svg
    }

    /// Numbers and names along both sides.
    fn axes(&self) -> String {
        let frame = &self.frame;
        let mut svg = String::new();
        let mut free_from = f64::NEG_INFINITY;
        for tick in &self.x_ticks {
            let (x, y, text) = (frame.at_x(tick.value), frame.bottom + 18.0, label(tick));
            let half = 0.5 * set_width(&text);
            if x - half > free_from {
                free_from = x + half + 4.0;
                let _infallible = write!(
                    svg,
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{text}</text>"
                );
            }
        }
        for tick in &self.y_ticks {
            let (x, y) = (frame.left - 6.0, frame.at_y(tick.value) + 4.0);
            let text = label(tick);
            let _infallible = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{text}</text>"
            );
        }
        svg + &axis_names(
            [&self.map.x.title(), &self.map.y.title()],
            (0.5 * (frame.left + frame.right), TOP + TALL + 40.0, WIDE),
            (TOP + 0.5 * TALL, TALL),
        )
    }

    /// What colours mean, and where the element ends behind that.
    fn bar(&self) -> (String, f64) {
        let left = self.frame.right + GAP;
        if !self.has_scores {
            return (String::new(), left);
        }
        let height = TALL / f64::from(STEPS);
        let steps = (0..STEPS).map(|step| {
            let (y, tall) = (TOP + height * f64::from(step), height + 0.5);
            let share = 1.0 - f64::from(step) / f64::from(STEPS - 1);
            let fill = hex(self.map.colour(share));
            format!(
                "<rect x=\"{left:.1}\" y=\"{y:.1}\" width=\"{BAR}\" height=\"{tall:.1}\" fill=\"{fill}\"/>"
            )
        });
        let ticks = self.scores.ticks(5);
        let beside = left + BAR + 6.0;
        let numbers = ticks.iter().map(|tick| {
            let y = TOP + (1.0 - self.scores.share(tick.value)) * TALL + 4.0;
            format!(
                "<text x=\"{beside:.1}\" y=\"{y:.1}\">{}</text>",
                label(tick)
            )
        });
        let name_x = beside + widest(&ticks) + 16.0;
        let up = TOP + 0.5 * TALL;
        let name = self.unit.label(&self.map.score_label) + self.scores.shape_remark();
        let name = html(&super::short(&name, TALL));
        let name = format!(
            "<text class=\"axis\" transform=\"translate({name_x:.1} {up:.1}) rotate(-90)\" text-anchor=\"middle\">{name}</text>"
        );
        (steps.chain(numbers).chain([name]).collect(), name_x + 6.0)
    }
}

impl InlineChart for HeatMap {
    fn inline(&self, inline: &Inline<'_>) -> String {
        let layout = Layout::new(self);
        let (bar, wide) = layout.bar();
        let tall = TOP + TALL + BELOW;
        format!(
            "<svg {}class=\"chart heat\" viewBox=\"0 0 {wide:.0} {tall:.0}\" role=\"img\" tabindex=\"0\" aria-label=\"{}\">{}{}{}{bar}</svg>",
            inline.id_attribute(),
            html(inline.alt),
            layout.cells(),
            layout.axes(),
            layout.marks(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_says_its_values_and_the_best_and_its_set_are_marked() {
        let axis = |name: &str, values: Vec<f64>| (AxisSpec::new(name, Unit::One), values);
        let scores = (0..6).map(|k| (k != 4).then_some(f64::from(k) + 1.0));
        let map = HeatMap {
            best: Some((0, 0)),
            indistinguishable: vec![true, true, false, false, false, false],
            table_rows: (0..6).map(Some).collect(),
            ..HeatMap::new(
                Caption::default(),
                [axis("a<b", vec![0.0, 1.0, 2.0]), axis("c", vec![0.0, 1.0])],
                scores.collect(),
                ("pca", Unit::Metre),
            )
        };
        let svg = map.inline(&Inline::new("Score").id("heat"));
        assert_eq!(svg.matches("data-point=").count(), 6);
        assert_eq!(svg.matches("cell lost").count(), 1);
        assert_eq!(svg.matches("in the confidence set").count(), 2);
        assert_eq!(svg.matches("class=\"outline\"").count(), 1);
        assert_eq!(svg.matches("class=\"star\"").count(), 1);
        assert!(!svg.contains("a<b") && svg.contains(&hex(score_colour(0.0))));
        roxmltree::Document::parse(&svg).unwrap();
        // Scores from 1 m to 6 m: their name and unit stand beside round numbers.
        for said in ["pca (m)", ">2</text>", ">6</text>"] {
            assert!(svg.contains(said), "{said}: {svg}");
        }
    }
}
