//! Columns: a few values for each of several things, side by side.

use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 760.0;
const MARGIN: f64 = 34.0;
/// Share of a group's width that is left between groups.
const BETWEEN: f64 = 0.25;

/// One colour of the columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnSeries {
    /// Text of the legend.
    pub label: String,
    /// One value a group; `None` where there is none.
    pub values: Vec<Option<f64>>,
}

/// Groups of columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnChart {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// What the height is, with its unit.
    pub label: String,
    /// Names of the groups, from left to right.
    pub groups: Vec<String>,
    /// The columns of every group.
    pub series: Vec<ColumnSeries>,
    /// How values are spread over heights; linear from 0 where some are negative.
    pub scale: ScoreScale,
}

/// Draws the columns into a PNG or SVG file.
///
/// # Errors
/// No finite value, a series with another number of values than groups, a path that is no picture's, a full disk.
pub fn draw_columns(chart: &ColumnChart, path: impl AsRef<Path>) -> Result<()> {
    picture::write(chart, path.as_ref())
}

impl ColumnChart {
    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let all = self.series.iter().flat_map(|series| &series.values);
        all.copied().flatten().filter(|value| value.is_finite())
    }
}

impl Picture for ColumnChart {
    fn check(&self) -> Result<()> {
        for series in &self.series {
            check_length(&series.label, series.values.len(), self.groups.len())?;
        }
        if self.values().next().is_none() {
            return Err(nothing(&self.caption.title, "at least one finite value"));
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let entries = self.series.iter().enumerate();
        let entries =
            entries.map(|(i, s)| (Symbol::Shade(stroke_of(i, 1.0).colour), s.label.clone()));
        let surround = HeadingAndLegend::new(&self.caption, entries.collect(), WIDTH, MARGIN);
        let bottom = surround.draw(canvas, HEIGHT);
        let (low, high) = ends_of(self.values().chain([0.0]));
        let room = 0.05 * (high - low);
        let values: Vec<f64> = self.values().collect();
        let y = match Scale::for_scores(&values, self.scale, AXIS_DECADES) {
            scale if scale.is_log => with_room(scale),
            _ => Scale::linear(if low < 0.0 { low - room } else { 0.0 }, high + room),
        };
        let ticks = y.ticks(6);
        let corner = (WIDTH - MARGIN, bottom - BELOW_TICKS);
        let x = Scale::linear(0.0, self.groups.len() as f64);
        let left = MARGIN + left_of_label(&ticks);
        let frame = Frame::new((left, surround.top()), corner, [x, y]);
        frame.draw_grid(canvas, &[], &ticks);
        let group = (frame.right - frame.left) / self.groups.len() as f64;
        let column = group * (1.0 - BETWEEN) / self.series.len().max(1) as f64;
        let zero = match y.is_log {
            true => frame.bottom,
            false => frame.at_y(0.0),
        };
        for (index, name) in self.groups.iter().enumerate() {
            let left = frame.left + group * (index as f64 + 0.5 * BETWEEN);
            for (place, series) in self.series.iter().enumerate() {
                let x = left + column * place as f64;
                match series.values[index].filter(|v| v.is_finite()) {
                    // A value of 0 is drawn as a line, so that it differs from a missing value.
                    Some(value) => {
                        let top = frame.at_y(value);
                        let (from, to) = (top.min(zero - 2.0), zero.max(top));
                        let (from, to) = ((x + 1.0, from), (x + column - 1.0, to));
                        canvas.fill(from, to, stroke_of(place, 1.0).colour);
                    }
                    None => {
                        let middle = (x + 0.5 * column, zero - 8.0);
                        let mut letter = tick_letter();
                        letter.colour = FAINT_INK;
                        canvas.text("-", middle, Align::Centre, letter);
                    }
                }
            }
            let name = shorten(name, Weight::Regular, TICK_SIZE, group - 6.0);
            let middle = frame.left + group * (index as f64 + 0.5);
            let anchor = (middle, frame.bottom + 8.0 + TICK_SIZE);
            canvas.text(&name, anchor, Align::Centre, tick_letter());
        }
        canvas.fill((frame.left, zero - 1.0), (frame.right, zero + 1.0), INK);
        let label = format!("{}{}", self.label, y.remark());
        frame.draw_y_axis(canvas, &ticks, &label);
        frame.draw_outline(canvas);
    }
}
