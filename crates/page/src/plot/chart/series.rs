//! A series of a chart: a line, dots or a band, and how it is drawn.

use crate::plot::kit::*;

/// Lines with more points than this have no disc at each point: the discs would hide the line.
const DISCS_AT_MOST: usize = 80;

/// Dash and gap of dashed lines.
const DASHED: Option<(f64, f64)> = Some((8.0, 6.0));

/// How a series is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum SeriesKind {
    /// A line through the points.
    Line,
    /// A line that keeps each value until the next point: the best so far.
    Steps,
    /// A thin line through the points: one of many.
    Thin,
    /// A line through the points with a disc at each of them, as long as there are few.
    Marked,
    /// A dot at each point.
    Dots,
    /// An area between each point's y and the second value given here, one a point.
    Band(Vec<f64>),
    /// A level: a thin dashed line through the points.
    Level,
    /// A dashed line in the colour of its series: the counterpart of a line.
    Dashed,
}

/// One series of a [`LinePlot`](crate::plot::LinePlot).
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Text of the legend.
    pub label: String,
    /// x and y; points that are not finite interrupt a line.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub kind: SeriesKind,
    /// Which of the colours; series that belong together share one.
    pub colour: usize,
    /// Whether it shows recordings: pages draw these in one colour everywhere.
    pub is_recorded: bool,
}

pub(in crate::plot) fn is_finite(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// Checks that bands have two edges of one length.
pub(in crate::plot) fn check_bands(all: &[Series]) -> Result<()> {
    for series in all {
        if let SeriesKind::Band(other) = &series.kind {
            check_length(&series.label, other.len(), series.points.len())?;
        }
    }
    Ok(())
}

/// Checks that there is something to draw of these; `field` is for the message.
pub(in crate::plot) fn check_points(field: &str, all: &[Series]) -> Result<()> {
    let mut points = finite_points(all);
    let missing = || nothing(field, "at least one finite point");
    points.next().map(|_| ()).ok_or_else(missing)
}

/// Every finite point, both edges of bands.
pub(in crate::plot) fn finite_points(all: &[Series]) -> impl Iterator<Item = Point> + '_ {
    all.iter()
        .flat_map(|series| {
            let other = match &series.kind {
                SeriesKind::Band(other) => other.as_slice(),
                _ => &[],
            };
            let edge = series.points.iter().zip(other).map(|((x, _), y)| (*x, *y));
            series.points.iter().copied().chain(edge)
        })
        .filter(is_finite)
}

impl Series {
    /// A series in the first colour.
    pub fn new(label: impl Into<String>, kind: SeriesKind, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: label.into(),
            points,
            kind,
            colour: 0,
            is_recorded: false,
        }
    }

    /// The same, of recordings.
    #[must_use]
    pub fn recorded(self) -> Self {
        Self {
            is_recorded: true,
            ..self
        }
    }

    pub(in crate::plot) fn is_band(&self) -> bool {
        matches!(self.kind, SeriesKind::Band(_))
    }

    /// The same in another colour.
    #[must_use]
    pub fn colour(self, colour: usize) -> Self {
        Self { colour, ..self }
    }

    /// How its line is drawn.
    fn stroke(&self) -> Stroke {
        let own = stroke_of(self.colour, 3.5);
        match self.kind {
            SeriesKind::Thin => Stroke { width: 2.0, ..own },
            SeriesKind::Dashed => Stroke::new(2.5, own.colour).dashed(DASHED),
            SeriesKind::Level => Stroke::new(2.0, FAINT_INK).dashed(DASHED),
            _ => own,
        }
    }
}

/// What the series that have a label are called.
pub(in crate::plot) fn legend(series: &[Series]) -> Vec<(Symbol, String)> {
    let entries = series.iter().filter(|series| !series.label.is_empty());
    let entries = entries.map(|series| {
        let colour = stroke_of(series.colour, 1.0).colour;
        let symbol = match series.kind {
            SeriesKind::Dots => Symbol::Dot(colour),
            SeriesKind::Band(_) => Symbol::Shade(tint(colour, 0.25)),
            _ => Symbol::Line(series.stroke()),
        };
        (symbol, series.label.clone())
    });
    entries.collect()
}

/// Each value kept until the next point.
pub(in crate::plot) fn stepped(run: &[Point]) -> Vec<Point> {
    let pairs = run.windows(2);
    let corners = pairs.flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(run.last().copied()).collect()
}

/// Draws a series whose values are shown in a unit of this size.
pub(in crate::plot) fn draw_series(
    canvas: &mut Canvas,
    frame: &Frame,
    series: &Series,
    factor: f64,
) {
    let colour = stroke_of(series.colour, 1.0).colour;
    let at = |(x, y): Point| (frame.at_x(x), frame.within_y(y * factor));
    match &series.kind {
        SeriesKind::Band(other) => {
            let points = series.points.iter().copied();
            let pairs: Vec<(Point, f64)> = points.zip(other.iter().copied()).collect();
            let runs = pairs.split(|(point, y)| !is_finite(point) || !y.is_finite());
            for run in runs {
                for pair in run.windows(2) {
                    let [(a, a_other), (b, b_other)] = [pair[0], pair[1]];
                    let corners = [a, b, (b.0, b_other), (a.0, a_other)].map(at);
                    canvas.polygon(&corners, tint(colour, 0.25));
                }
            }
        }
        SeriesKind::Dots => {
            for point in series.points.iter().filter(|point| is_finite(point)) {
                canvas.disc(at(*point), 4.5, tint(colour, 0.75));
            }
        }
        SeriesKind::Marked => {
            // A value without a score interrupts the line: nothing is known there.
            for run in series.points.split(|point| !is_finite(point)) {
                let run: Vec<Point> = run.iter().copied().map(at).collect();
                canvas.path(&run, series.stroke());
            }
            if series.points.len() <= DISCS_AT_MOST {
                for point in series.points.iter().filter(|point| is_finite(point)) {
                    canvas.disc(at(*point), 6.5, WHITE);
                    canvas.disc(at(*point), 5.0, colour);
                }
            }
        }
        _ => {
            for run in series.points.split(|point| !is_finite(point)) {
                let run = match series.kind {
                    SeriesKind::Steps => stepped(run),
                    _ => run.to_vec(),
                };
                let run: Vec<Point> = run.into_iter().map(at).collect();
                canvas.path(&run, series.stroke());
            }
        }
    }
}
