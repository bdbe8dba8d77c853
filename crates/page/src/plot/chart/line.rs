//! Lines, dots and bands over one quantity: a score over a parameter, convergence, errors and confidence over time, paths.

use super::series::{
    Series, SeriesKind, check_bands, check_points, draw_series, finite_points, is_finite, legend,
};
use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 800.0;
const MARGIN: f64 = 34.0;

/// Height of the strip at the top of the frame in which diverged points are marked.
const STRIP: f64 = 34.0;

/// The values of a parameter that the horizontal axis shows, with what is known of each value.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterGrid {
    /// The values, strictly increasing.
    pub values: Vec<f64>,
    /// Whether the value belongs to the confidence set: it cannot be told from the best. Empty for none.
    pub indistinguishable: Vec<bool>,
    /// Whether the simulation at the value diverged, so that it has no score. Empty for none.
    pub diverged: Vec<bool>,
}

/// The point with the best score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BestPoint {
    /// Its value on the horizontal axis.
    pub x: f64,
    /// Its score, in the unit of the vertical axis; `None` where it diverged.
    pub score: Option<f64>,
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
    /// The values of the parameter that the horizontal axis shows; `None` where it shows something else.
    pub grid: Option<ParameterGrid>,
    /// The best point, which gets a star.
    pub best: Option<BestPoint>,
    /// The true value on the horizontal axis, where it is known.
    pub truth: Option<Truth>,
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
            grid: None,
            best: None,
            truth: None,
        }
    }

    /// A score over the values of one parameter: one line with the best point and the confidence set. `scores` has one
    /// entry a value, `None` where the simulation diverged.
    pub(crate) fn over_parameter(
        caption: Caption,
        x: AxisSpec,
        score: (&str, Unit),
        values: Vec<f64>,
        scores: &[Option<f64>],
        indistinguishable: Vec<bool>,
    ) -> Self {
        let finite = |score: &Option<f64>| score.filter(|score| score.is_finite());
        let scores = scores.iter().map(finite).collect::<Vec<_>>();
        let points = values.iter().zip(&scores);
        let points = points.map(|(x, score)| (*x, score.unwrap_or(f64::NAN)));
        let line = Series::new("", SeriesKind::Marked, points.collect());
        Self {
            scale: ScoreScale::Auto,
            grid: Some(ParameterGrid {
                values,
                indistinguishable,
                diverged: scores.iter().map(Option::is_none).collect(),
            }),
            ..Self::new(caption, x, score, vec![line])
        }
    }
}

/// Draws the series into a PNG or SVG file.
///
/// # Errors
/// No finite point at all where the axis shows no parameter, a band of the wrong length, a path that is no picture's, a full
/// disk.
pub fn draw_lines(plot: &LinePlot, path: impl AsRef<Path>) -> Result<()> {
    picture::write(plot, path.as_ref())
}

impl LinePlot {
    /// Places and numbers of the parameter's grid, if the axis shows one.
    fn check_grid(&self, grid: &ParameterGrid) -> Result<()> {
        check_values("values", &grid.values)?;
        for (name, marks) in [
            ("indistinguishable", &grid.indistinguishable),
            ("diverged", &grid.diverged),
        ] {
            if !marks.is_empty() {
                check_length(name, marks.len(), grid.values.len())?;
            }
        }
        Ok(())
    }

    /// How many values of the parameter have no score.
    pub(in crate::plot) fn diverged(&self) -> usize {
        let grids = self.grid.iter();
        let marks = grids.flat_map(|grid| &grid.diverged);
        marks.filter(|is_diverged| **is_diverged).count()
    }

    /// The values that decide the vertical scale. A band around a score over a parameter may leave the frame: the score
    /// decides.
    fn heights(&self) -> Vec<f64> {
        match self.grid {
            None => finite_points(&self.series).map(|(_, y)| y).collect(),
            Some(_) => {
                let series = self.series.iter().filter(|series| !series.is_band());
                let points = series.flat_map(|series| &series.points);
                points.filter(|p| is_finite(p)).map(|p| p.1).collect()
            }
        }
    }

    /// The unit in which the vertical values read well.
    pub(in crate::plot) fn display_unit(&self) -> DisplayUnit {
        DisplayUnit::for_values(self.y_unit, self.heights())
    }

    /// The vertical scale for values times `factor`.
    pub(in crate::plot) fn y_scale(&self, factor: f64) -> Scale {
        match self.y_range {
            Some((low, high)) => Scale::linear(low * factor, high * factor),
            None => {
                let heights = self.heights().into_iter();
                let shown: Vec<f64> = heights.map(|y| y * factor).collect();
                with_room(Scale::for_scores(&shown, self.scale, AXIS_DECADES))
            }
        }
    }

    /// The horizontal scale where it does not depend on the vertical one.
    pub(in crate::plot) fn x_scale(&self) -> Scale {
        if let Some(grid) = &self.grid {
            let edges = edges(&grid.values);
            return Scale::linear(edges[0], edges[edges.len() - 1]);
        }
        let (low, high) = ends_of(finite_points(&self.series).map(|(x, _)| x));
        if low > high {
            return Scale::linear(0.0, 1.0);
        }
        // A line may end at the frame; a dot there would be cut in half.
        let only_dots = self.series.iter().all(|s| s.kind == SeriesKind::Dots);
        let room = if only_dots { 0.03 * (high - low) } else { 0.0 };
        Scale::linear(low - room, high + room)
    }

    /// Ticks of the horizontal axis.
    pub(in crate::plot) fn x_ticks(&self, x: &Scale, count: usize) -> Vec<Tick> {
        match &self.grid {
            Some(grid) => axis::ticks(&self.x, &grid.values, x, count),
            None => axis::round_ticks(&self.x, x, count),
        }
    }

    /// Marks and labelled series with their texts.
    pub(in crate::plot) fn legend(&self, unit: DisplayUnit) -> Vec<(Symbol, String)> {
        let best = self.best.map(|best| {
            let place = self.x.at(best.x);
            (Symbol::Star, best_text(unit, best.score, &place))
        });
        let set = self.grid.as_ref();
        let set = set.and_then(|grid| alike_text(&grid.indistinguishable));
        let set = set.map(|text| (Symbol::Shade(SHADE), text));
        let diverged = self.diverged();
        let diverged = (diverged > 0).then(|| (Symbol::Cross, format!("diverged ({diverged})")));
        let truth = self.truth.as_ref().map(|truth| {
            let text = format!("{}: {}", truth.label, self.x.at(truth.x));
            (Symbol::Line(truth_line()), text)
        });
        let marks = [best, set, diverged, truth].into_iter().flatten();
        marks.chain(legend(&self.series)).collect()
    }

    /// Shades the cells around values that cannot be told from the best.
    fn draw_set(&self, canvas: &mut Canvas, frame: &Frame) {
        let Some(grid) = &self.grid else {
            return;
        };
        let edges = edges(&grid.values);
        let at = |edge: f64| frame.at_x(edge).clamp(frame.left, frame.right);
        let marked = grid.indistinguishable.iter().zip(edges.windows(2));
        for (_, ends) in marked.filter(|(inside, _)| **inside) {
            let (from, to) = (at(ends[0]), at(ends[1]));
            canvas.cell((from, frame.top), (to, frame.bottom), SHADE);
        }
    }

    /// A row of crosses at the top where a simulation diverged.
    fn draw_crosses(&self, canvas: &mut Canvas, whole: &Frame) {
        let Some(grid) = &self.grid else {
            return;
        };
        let mut free_from = f64::NEG_INFINITY;
        let diverged = grid.values.iter().zip(&grid.diverged);
        for (value, _) in diverged.filter(|(_, is_diverged)| **is_diverged) {
            let x = whole.at_x(*value);
            // A dense row of crosses is as clear as a complete one, and can be read.
            if x >= free_from {
                draw_cross(canvas, (x, whole.top + STRIP / 2.0));
                free_from = x + 20.0;
            }
        }
    }
}

fn truth_line() -> Stroke {
    Stroke::new(3.0, VERMILLION).dashed(Some((10.0, 7.0)))
}

impl LinePlot {
    /// Both scales for a room of this width and height, its left part for labels.
    fn scales(&self, factor: f64, (wide, high): Point) -> [Scale; 2] {
        let y = self.y_scale(factor);
        if self.scale != ScoreScale::LikeX {
            return [self.x_scale(), y];
        }
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = ends_of(values);
            (low - 0.03 * (high - low), high + 0.03 * (high - low))
        };
        let across = range(&mut finite_points(&self.series).map(|(x, _)| x));
        let up = range(&mut finite_points(&self.series).map(|(_, y)| factor * y));
        let shape = |y: &Scale| (wide - left_of_label(&y.ticks(7))) / high;
        let (_, rough) = equal_aspect(across, up, shape(&y));
        let (x, y) = equal_aspect(across, up, shape(&rough));
        [x, y]
    }
}

impl Picture for LinePlot {
    fn check(&self) -> Result<()> {
        check_bands(&self.series)?;
        match &self.grid {
            Some(grid) => self.check_grid(grid),
            None => check_points(&self.caption.title, &self.series),
        }
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let unit = self.display_unit();
        let surround = HeadingAndLegend::new(&self.caption, self.legend(unit), WIDTH, MARGIN);
        let strip = if self.diverged() > 0 { STRIP } else { 0.0 };
        let (top, bottom) = (surround.top(), surround.draw(canvas, HEIGHT) - BELOW_LABEL);
        let room = (WIDTH - MARGIN - MARGIN, bottom - top);
        let [x, y] = self.scales(unit.factor, room);
        let x_ticks = self.x_ticks(&x, 9);
        let is_empty = self.heights().is_empty();
        let y_ticks = y.ticks(if is_empty { 0 } else { 7 });
        let left = MARGIN + left_of_label(&y_ticks);
        let frame = Frame::new((left, top + strip), (WIDTH - MARGIN, bottom), [x, y]);
        let whole = Frame { top, ..frame };
        self.draw_set(canvas, &whole);
        // Bands lie under the grid, so that it can be read through them.
        let (bands, above): (Vec<_>, Vec<_>) = self.series.iter().partition(|s| s.is_band());
        for series in bands {
            draw_series(canvas, &frame, series, unit.factor);
        }
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        let truth = self.truth.iter().map(|truth| truth.x);
        for x in truth.filter(|x| (0.0..=1.0).contains(&frame.x.share(*x))) {
            let x = frame.at_x(x);
            canvas.path(&[(x, whole.top), (x, whole.bottom)], truth_line());
        }
        self.draw_crosses(canvas, &whole);
        for series in above {
            draw_series(canvas, &frame, series, unit.factor);
        }
        if let Some(BestPoint {
            x,
            score: Some(score),
        }) = self.best
        {
            let height = frame.within_y(score * unit.factor);
            draw_star(canvas, (frame.at_x(x), height));
        }
        whole.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &self.x.title());
        let label = format!("{}{}", unit.label(&self.y_label), y.remark());
        frame.draw_y_axis(canvas, &y_ticks, &label);
        if is_empty {
            frame.draw_nothing(canvas);
        }
    }
}
