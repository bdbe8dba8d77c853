//! Lines, dots and bands over one quantity: convergence, errors over time, confidence over time.

use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

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

impl LinePlot {
    /// Series over two linear axes that end where the points do; `y` is the vertical quantity and the unit of its values.
    pub fn new(caption: Caption, x: AxisSpec, y: (&str, Unit), series: Vec<Series>) -> Self {
        Self {
            caption,
            x,
            y_label: y.0.to_owned(),
            y_unit: y.1,
            scale: ScoreScale::Linear,
            y_range: None,
            series,
        }
    }
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
        check_points(&self.caption.title, &self.series)
    }
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
        }
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
fn stepped(run: &[Point]) -> Vec<Point> {
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

impl LinePlot {
    /// Both scales for these points of a room of this width and height, its left part for labels.
    fn scales(&self, xs: &[f64], ys: &[f64], factor: f64, (wide, high): Point) -> [Scale; 2] {
        let range = |values: &[f64], room: f64| {
            let (low, high) = ends_of(values.iter().copied());
            (low - room * (high - low), high + room * (high - low))
        };
        let y = match self.y_range {
            Some((low, high)) => Scale::linear(low * factor, high * factor),
            None => with_room(Scale::for_scores(ys, self.scale, AXIS_DECADES)),
        };
        if self.scale == ScoreScale::LikeX {
            let (across, up) = (range(xs, 0.03), range(ys, 0.03));
            let shape = |y: &Scale| (wide - left_of_label(&y.ticks(7))) / high;
            let (_, rough) = equal_aspect(across, up, shape(&y));
            let (x, y) = equal_aspect(across, up, shape(&rough));
            return [x, y];
        }
        // A line may end at the frame; a dot there would be cut in half.
        let only_dots = self.series.iter().all(|s| s.kind == SeriesKind::Dots);
        let (low, high) = range(xs, if only_dots { 0.03 } else { 0.0 });
        [Scale::linear(low, high), y]
    }
}

impl Picture for LinePlot {
    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (xs, ys): (Vec<f64>, Vec<f64>) = finite_points(&self.series).unzip();
        let unit = DisplayUnit::for_values(self.y_unit, ys.iter().copied());
        let shown: Vec<f64> = ys.iter().map(|y| y * unit.factor).collect();
        let sheet = Sheet::new(&self.caption, legend(&self.series), WIDTH, MARGIN);
        let (top, bottom) = (sheet.top(), sheet.draw(canvas, HEIGHT) - BELOW_LABEL);
        let room = (WIDTH - MARGIN - MARGIN, bottom - top);
        let [x, y] = self.scales(&xs, &shown, unit.factor, room);
        let x_ticks = axis::round_ticks(&self.x, &x, 9);
        let y_ticks = y.ticks(7);
        let left = MARGIN + left_of_label(&y_ticks);
        let frame = Frame::new((left, top), (WIDTH - MARGIN, bottom), [x, y]);
        // Bands lie under the grid, so that it can be read through them.
        let is_band = |series: &&Series| matches!(series.kind, SeriesKind::Band(_));
        let (bands, above): (Vec<_>, Vec<_>) = self.series.iter().partition(is_band);
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
