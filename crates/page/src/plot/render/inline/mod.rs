//! Charts as SVG elements inside of a page: readable without scripts, in a light and a dark theme, and on paper.
//!
//! Colours are classes (`sim`, `real`, `band`), which the style sheet of the page fills in. The scripts find charts by the
//! attribute `data-chart`: over `time` they add a cursor, on a `map` dots, which follow the replay.

mod lines;
mod map;

pub(crate) use lines::legend;

use crate::markup::html;
use crate::plot::layout::scale::Tick;

/// What the name of the upright axis takes, with the gaps beside it and the numbers.
const LABEL: f64 = 26.0;

/// What a page adds to a chart.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Inline<'a> {
    /// The alternative text, for readers who do not see the chart.
    pub alt: &'a str,
    /// The identifier by which the scripts find the chart; empty for none.
    pub id: &'a str,
    /// Whether the horizontal axis is the time of the replay although its unit is not the second.
    pub follows_time: bool,
}

impl<'a> Inline<'a> {
    /// A chart with this alternative text.
    pub(crate) fn new(alt: &'a str) -> Self {
        Self {
            alt,
            ..Self::default()
        }
    }

    /// The same chart with an identifier.
    pub(crate) fn id(self, id: &'a str) -> Self {
        Self { id, ..self }
    }

    fn id_attribute(&self) -> String {
        match self.id {
            "" => String::new(),
            id => format!("id=\"{id}\" "),
        }
    }
}

/// A chart that a page can hold.
pub(crate) trait InlineChart {
    /// The chart as an `svg` element.
    fn inline(&self, inline: &Inline<'_>) -> String;
}

/// Labels of ticks as a page writes them: a hyphen is what screen readers read as a minus everywhere.
fn label(tick: &Tick) -> String {
    tick.label.replace('−', "-")
}

/// The greatest width of a number in 15.5 units, the size of texts on a narrow screen, whatever font the reader has.
fn set_width(text: &str) -> f64 {
    let wide = |c: char| if ".,-−".contains(c) { 5.8 } else { 9.9 };
    text.chars().map(wide).sum()
}

fn widest(ticks: &[Tick]) -> f64 {
    let widths = ticks.iter().map(|tick| set_width(&label(tick)));
    widths.fold(0.0, f64::max)
}

/// The name of an axis in this much room. Of a name that is too long the middle is cut, so that the unit at its end stays.
fn short(name: &str, room: f64) -> String {
    const LETTER: f64 = 9.0;
    let most = (room / LETTER) as usize;
    if name.chars().count() <= most {
        return name.to_owned();
    }
    let (name, unit) = match name.rfind(" (") {
        Some(at) => name.split_at(at),
        None => (name, ""),
    };
    let room = most.saturating_sub(1 + unit.chars().count());
    let kept: String = name.chars().take(room).collect();
    format!("{}…{unit}", kept.trim_end())
}

/// The names of both axes, below the middle of the frame and beside it.
fn axis_names([x, y]: [&str; 2], below: (f64, f64, f64), beside: (f64, f64)) -> String {
    let (middle, baseline, wide) = below;
    let (centre, tall) = beside;
    format!(
        "<text class=\"axis\" x=\"{middle:.1}\" y=\"{baseline:.1}\" text-anchor=\"middle\">{}</text>\
         <text class=\"axis\" transform=\"translate(14 {centre:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        html(&short(x, wide)),
        html(&short(y, tall)),
    )
}

/// The mark of the best point: a star.
fn star((x, y): (f64, f64)) -> String {
    let points = (0..10).map(|k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 10.0).sin_cos();
        let radius = if k % 2 == 0 { 8.0 } else { 3.6 };
        format!("{:.1},{:.1}", x + radius * sin, y - radius * cos)
    });
    let points: Vec<String> = points.collect();
    format!("<polygon class=\"star\" points=\"{}\"/>", points.join(" "))
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn a_long_name_of_an_axis_keeps_its_unit() {
        assert_eq!(short("time (s)", 100.0), "time (s)");
        let name = "RMS distance from the recordings (m)";
        let cut = short(name, 200.0);
        assert!(cut.ends_with("… (m)") && cut.chars().count() <= 22, "{cut}");
    }
}
