//! A heat map as SVG inside of a page: a cell a point, its values on hover, a frame around what cannot be told from the best.

use std::fmt::Write as _;

use super::page::html;
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

/// Colours of viridis, from the best score to the worst: light to dark, in any colour blindness.
const COLOURS: [[f64; 3]; 9] = [
    [253.0, 231.0, 37.0],
    [170.0, 220.0, 50.0],
    [94.0, 201.0, 98.0],
    [39.0, 173.0, 129.0],
    [33.0, 145.0, 140.0],
    [44.0, 114.0, 142.0],
    [59.0, 82.0, 139.0],
    [71.0, 45.0, 123.0],
    [68.0, 1.0, 84.0],
];

fn colour(share: f64) -> String {
    let at = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let below = (at.floor() as usize).min(COLOURS.len() - 2);
    let mix = |channel: usize| {
        let (a, b) = (COLOURS[below][channel], COLOURS[below + 1][channel]);
        (a + (b - a) * (at - below as f64)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// The values that a parameter takes, in order.
fn values(points: &[Point], parameter: usize) -> Vec<f64> {
    let mut all: Vec<f64> = points.iter().map(|p| p.values[parameter]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The map of the first two parameters; `None` where the points are no grid of two parameters.
pub(super) fn heat_map(points: &[Point], names: &[String], unit: &str) -> Option<String> {
    if names.len() != 2 || points.is_empty() {
        return None;
    }
    let (xs, ys) = (values(points, 0), values(points, 1));
    if xs.len() * ys.len() != points.len() || xs.len() > 200 || ys.len() > 200 {
        return None;
    }
    let scores = || points.iter().filter_map(|point| point.score);
    let low = scores().fold(f64::INFINITY, f64::min);
    let high = scores().fold(f64::NEG_INFINITY, f64::max);
    let (left, top, wide, tall) = (60.0, 12.0, 440.0, 340.0);
    let (cell_x, cell_y) = (wide / xs.len() as f64, tall / ys.len() as f64);
    let place = |all: &[f64], value: f64| all.iter().position(|v| *v == value).unwrap_or(0) as f64;
    let mut svg = format!(
        "<svg class=\"chart heat\" id=\"heat\" viewBox=\"0 0 580 410\" role=\"img\" tabindex=\"0\" aria-label=\"Score over {} and {}; the same numbers are in the table of points\">",
        html(&names[0]),
        html(&names[1]),
    );
    let best = points.iter().position(|point| point.score == Some(low));
    let mut frames = String::new();
    for (index, point) in points.iter().enumerate() {
        let x = left + place(&xs, point.values[0]) * cell_x;
        let y = top + tall - (place(&ys, point.values[1]) + 1.0) * cell_y;
        let shown = point.score.map_or_else(
            || "diverged".to_owned(),
            |score| format!("{} {unit}", number(score)),
        );
        let (class, fill) = match point.score {
            Some(score) => (
                "cell",
                colour((score - low) / (high - low).max(f64::MIN_POSITIVE)),
            ),
            None => ("cell lost", "#888888".to_owned()),
        };
        let _infallible = write!(
            svg,
            "<rect class=\"{class}\" data-point=\"{index}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{cell_x:.1}\" height=\"{cell_y:.1}\" fill=\"{fill}\"><title>{} = {}, {} = {}: {}{}</title></rect>",
            html(&names[0]),
            number(point.values[0]),
            html(&names[1]),
            number(point.values[1]),
            html(&shown),
            if point.is_in {
                ", cannot be told from the best"
            } else {
                ""
            },
        );
        if point.is_in || best == Some(index) {
            let class = if best == Some(index) { "best" } else { "in" };
            let _infallible = write!(
                frames,
                "<rect class=\"frame {class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                x + 1.5,
                y + 1.5,
                (cell_x - 3.0).max(1.0),
                (cell_y - 3.0).max(1.0),
            );
        }
    }
    svg.push_str(&frames);
    for (all, is_x) in [(&xs, true), (&ys, false)] {
        let every = all.len().div_ceil(6);
        for (index, value) in all.iter().enumerate().step_by(every) {
            let (x, y, anchor) = if is_x {
                (
                    left + (index as f64 + 0.5) * cell_x,
                    top + tall + 16.0,
                    "middle",
                )
            } else {
                (
                    left - 6.0,
                    top + tall - (index as f64 + 0.5) * cell_y + 4.0,
                    "end",
                )
            };
            let _infallible = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
                number(*value)
            );
        }
    }
    let _infallible = write!(
        svg,
        "<text class=\"axis\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text><text class=\"axis\" transform=\"translate(13 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        left + 0.5 * wide,
        top + tall + 38.0,
        html(&names[0]),
        top + 0.5 * tall,
        html(&names[1]),
    );
    for step in 0..32 {
        let y = top + tall * f64::from(step) / 32.0;
        let _infallible = write!(
            svg,
            "<rect x=\"516\" y=\"{y:.1}\" width=\"14\" height=\"{:.1}\" fill=\"{}\"/>",
            tall / 32.0 + 0.5,
            colour(1.0 - f64::from(step) / 31.0),
        );
    }
    let _infallible = write!(
        svg,
        "<text x=\"535\" y=\"{:.1}\">{}</text><text x=\"535\" y=\"{:.1}\">{}</text><text x=\"535\" y=\"{:.1}\">{}</text></svg>",
        top + 10.0,
        number(high),
        top + tall,
        number(low),
        top + 0.5 * tall,
        html(unit),
    );
    Some(svg)
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
        let svg = heat_map(&points, &names, "m").unwrap();
        assert_eq!(svg.matches("data-point=").count(), 6);
        assert_eq!(svg.matches("frame best").count(), 1);
        assert_eq!(svg.matches("cell lost").count(), 1);
        assert!(!svg.contains("a<b") && svg.contains("#fde725"));
        roxmltree::Document::parse(&svg).unwrap();
        assert!(heat_map(&points[1..], &names, "m").is_none(), "no grid");
    }
}
