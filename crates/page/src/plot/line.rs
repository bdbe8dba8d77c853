//! Lines, dots and bands over one quantity: convergence, errors over time, confidence over time.

use std::path::Path;

use plotters::backend::DrawingBackend;

use super::axis::{self, AxisSpec};
use super::canvas::{Canvas, Point};
use super::colour::{FAINT_INK, line, tint};
use super::frame::{BELOW_LABEL, Frame, left_of_label};
use super::heading::{Caption, Heading};
use super::legend::{Legend, Symbol};
use super::path::equal_aspect;
use super::picture::{self, Picture};
use super::scale::{AXIS_DECADES, Scale, ScoreScale, with_room};
use realgap_core::Error;
use realgap_core::Result;
use realgap_core::unit::DisplayUnit;
use realgap_core::unit::Unit;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 800.0;
const MARGIN: f64 = 34.0;

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
    /// A dot at each point.
    Dots,
    /// An area between each point's y and the second value given here, one a point.
    Band(Vec<f64>),
    /// A level: a thin dashed line through the points.
    Level,
    /// A dashed line in the colour of its series: the counterpart of a line.
    Dashed,
}

/// One series of a [`LinePlot`].
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
}

/// Several series over the same axes.
#[derive(Debug, Clone, PartialEq)]
pub struct LinePlot {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The horizontal quantity.
    pub x: AxisSpec,
    /// What the vertical quantity is.
    pub y_label: String,
    /// Unit of the y values given; they are shown in one of handy size.
    pub y_unit: Unit,
    /// How y values become heights.
    pub scale: ScoreScale,
    /// Ends of the vertical axis where they are fixed, e.g. 0 and 1 for a probability, in `y_unit`.
    pub y_range: Option<(f64, f64)>,
    /// What is drawn, later ones above earlier ones.
    pub series: Vec<Series>,
}

/// Draws the series into a PNG or SVG file.
///
/// # Errors
/// No finite point at all, a band of the wrong length, a path that is no picture's, a full disk.
pub fn draw_lines(plot: &LinePlot, path: impl AsRef<Path>) -> Result<()> {
    plot.check()?;
    picture::write(plot, path.as_ref())
}

fn is_finite(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

impl LinePlot {
    fn check(&self) -> Result<()> {
        check_bands(&self.series)?;
        if finite_points(&self.series).next().is_none() {
            return Err(Error::invalid("there is nothing to draw")
                .field(&self.caption.title)
                .allowed("at least one finite point"));
        }
        Ok(())
    }
}

/// Checks that bands have two edges of one length.
pub(super) fn check_bands(all: &[Series]) -> Result<()> {
    for series in all {
        if let SeriesKind::Band(other) = &series.kind {
            axis::check_length(&series.label, other.len(), series.points.len())?;
        }
    }
    Ok(())
}

/// Every finite point, both edges of bands.
pub(super) fn finite_points(all: &[Series]) -> impl Iterator<Item = Point> + '_ {
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

/// What the series that have a label are called, in rows no wider than this.
pub(super) fn legend(series: &[Series], width: f64) -> Legend {
    let entries = series.iter().filter(|series| !series.label.is_empty());
    let entries = entries.map(|series| {
        let (colour, dash) = line(series.colour);
        let symbol = match series.kind {
            SeriesKind::Line | SeriesKind::Steps => Symbol::Line {
                colour,
                width: 3.5,
                dash,
            },
            SeriesKind::Thin => Symbol::Line {
                colour,
                width: 2.0,
                dash,
            },
            SeriesKind::Dots => Symbol::Dot(colour),
            SeriesKind::Band(_) => Symbol::Shade(tint(colour, 0.25)),
            SeriesKind::Dashed => Symbol::Line {
                colour,
                width: 2.5,
                dash: DASHED,
            },
            SeriesKind::Level => Symbol::Line {
                colour: FAINT_INK,
                width: 2.0,
                dash: DASHED,
            },
        };
        (symbol, series.label.clone())
    });
    Legend::new(entries.collect(), width)
}

/// Each value kept until the next point.
fn stepped(run: &[Point]) -> Vec<Point> {
    let corners = run
        .windows(2)
        .flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(run.last().copied()).collect()
}

/// Draws a series whose values are shown in a unit of this size.
pub(super) fn draw_series<B: DrawingBackend>(
    canvas: &mut Canvas<B>,
    frame: &Frame,
    series: &Series,
    factor: f64,
) {
    let (colour, dash) = line(series.colour);
    let at = |(x, y): Point| {
        let share = frame.y.share(y * factor).clamp(0.0, 1.0);
        (
            frame.at_x(x),
            frame.bottom - share * (frame.bottom - frame.top),
        )
    };
    match &series.kind {
        SeriesKind::Band(other) => {
            let pairs: Vec<(Point, f64)> = series
                .points
                .iter()
                .copied()
                .zip(other.iter().copied())
                .collect();
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
        SeriesKind::Line
        | SeriesKind::Steps
        | SeriesKind::Thin
        | SeriesKind::Level
        | SeriesKind::Dashed => {
            for run in series.points.split(|point| !is_finite(point)) {
                let run = match series.kind {
                    SeriesKind::Steps => stepped(run),
                    _ => run.to_vec(),
                };
                let run: Vec<Point> = run.into_iter().map(at).collect();
                let (width, colour, dash) = match series.kind {
                    SeriesKind::Level => (2.0, FAINT_INK, DASHED),
                    SeriesKind::Dashed => (2.5, colour, DASHED),
                    SeriesKind::Thin => (2.0, colour, dash),
                    _ => (3.5, colour, dash),
                };
                canvas.path(&run, width, colour, dash);
            }
        }
    }
}

impl Picture for LinePlot {
    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<B>) {
        let (xs, ys): (Vec<f64>, Vec<f64>) = finite_points(&self.series).unzip();
        let unit = DisplayUnit::for_values(self.y_unit, ys.iter().copied());
        let shown: Vec<f64> = ys.iter().map(|y| y * unit.factor).collect();
        let y = match self.y_range {
            Some((low, high)) => Scale::linear(low * unit.factor, high * unit.factor),
            None => with_room(Scale::for_scores(&shown, self.scale, AXIS_DECADES)),
        };
        let heading = Heading::new(&self.caption, WIDTH - 2.0 * MARGIN);
        heading.draw(canvas, MARGIN, 14.0);
        let legend = legend(&self.series, WIDTH - 2.0 * MARGIN);
        let legend_top = HEIGHT - 16.0 - legend.height();
        legend.draw(canvas, MARGIN, legend_top);

        let low = xs.iter().copied().fold(f64::INFINITY, f64::min);
        let high = xs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // A line may end at the frame; a dot there would be cut in half.
        let only_dots = self.series.iter().all(|s| s.kind == SeriesKind::Dots);
        let room = if only_dots { 0.03 * (high - low) } else { 0.0 };
        let (top, bottom) = (
            14.0 + heading.height() + 22.0,
            legend_top - 14.0 - BELOW_LABEL,
        );
        let left_of = |y: &Scale| MARGIN + left_of_label(&y.ticks(7));
        let (x, y) = if self.scale == ScoreScale::LikeX {
            let ends = |values: &[f64]| {
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                (low - 0.03 * (high - low), high + 0.03 * (high - low))
            };
            let (across, up) = (ends(&xs), ends(&shown));
            let shape = |left: f64| (WIDTH - MARGIN - left) / (bottom - top);
            let (_, rough) = equal_aspect(across, up, shape(left_of(&y)));
            equal_aspect(across, up, shape(left_of(&rough)))
        } else {
            (Scale::linear(low - room, high + room), y)
        };
        let x_ticks = axis::round_ticks(&self.x, &x, 9);
        let y_ticks = y.ticks(7);
        let frame = Frame {
            left: left_of(&y),
            top,
            right: WIDTH - MARGIN,
            bottom,
            x,
            y,
        };
        // Bands lie under the grid, so that it can be read through them.
        let (bands, above): (Vec<&Series>, Vec<&Series>) = self
            .series
            .iter()
            .partition(|series| matches!(series.kind, SeriesKind::Band(_)));
        for series in bands {
            draw_series(canvas, &frame, series, unit.factor);
        }
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        for series in above {
            draw_series(canvas, &frame, series, unit.factor);
        }
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &self.x.title());
        let label = format!("{}{}", unit.label(&self.y_label), y.remark());
        frame.draw_y_axis(canvas, &y_ticks, &label);
    }
}
