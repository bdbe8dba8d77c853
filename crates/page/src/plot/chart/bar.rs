//! Bars: how much each of several causes changes a result, the largest change first.

use crate::plot::kit::*;
use realgap_core::statistics::ends_of;

const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 34.0;
const ROW: f64 = 34.0;
const NAMES: f64 = 420.0;

/// One cause: the change when it is made smaller and larger.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What is changed.
    pub name: String,
    /// Change when it is smaller; `None` where that is not possible or failed.
    pub lower: Option<f64>,
    /// Change when it is larger.
    pub higher: Option<f64>,
}

/// A chart of horizontal bars around 0.
#[derive(Debug, Clone, PartialEq)]
pub struct BarChart {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// What the changes are changes of.
    pub label: String,
    /// Unit of the changes.
    pub unit: Unit,
    /// The bars, from top to bottom.
    pub bars: Vec<Bar>,
    /// Changes smaller than this may be chance; the range is shaded.
    pub noise: Option<f64>,
}

/// Draws the bars into a PNG or SVG file.
///
/// # Errors
/// No bar, a path that is no picture's, a full disk.
pub fn draw_bars(chart: &BarChart, path: impl AsRef<Path>) -> Result<()> {
    picture::write(chart, path.as_ref())
}

impl BarChart {
    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        let all = self.bars.iter().flat_map(|bar| [bar.lower, bar.higher]);
        all.flatten().filter(|value| value.is_finite())
    }
}

impl Picture for BarChart {
    fn check(&self) -> Result<()> {
        if self.bars.is_empty() {
            return Err(Error::invalid("there is nothing to draw").field(&self.caption.title));
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, (260.0 + ROW * self.bars.len() as f64) as u32)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let height = f64::from(self.size().1);
        let unit = DisplayUnit::for_values(self.unit, self.values());
        let noise = self.noise.unwrap_or(0.0);
        let all = self.values().chain([0.0, noise, -noise]);
        let (low, high) = ends_of(all.map(|value| value * unit.factor));
        let room = 0.05 * (high - low);
        let noise_text = "no more than a slightly different start changes (1 sd)";
        let entries = [
            (VERMILLION, Some("parameter made smaller")),
            (BLUE, Some("parameter made larger")),
            (SHADE, self.noise.map(|_| noise_text)),
        ];
        let entries = entries.into_iter();
        let entries = entries.filter_map(|(c, text)| Some((Symbol::Shade(c), text?.to_owned())));
        let surround = HeadingAndLegend::new(&self.caption, entries.collect(), WIDTH, MARGIN);
        let bottom = surround.draw(canvas, height);
        let x = Scale::linear(low - room, high + room);
        let x_ticks = x.ticks(7);
        let corner = (WIDTH - MARGIN, bottom - BELOW_LABEL);
        let y = Scale::linear(0.0, 1.0);
        let frame = Frame::new((MARGIN + NAMES, surround.top()), corner, [x, y]);
        if let Some(noise) = self.noise {
            let edge = noise * unit.factor;
            let (from, to) = (frame.at_x(-edge), frame.at_x(edge));
            canvas.cell((from, frame.top), (to, frame.bottom), SHADE);
        }
        frame.draw_grid(canvas, &x_ticks, &[]);
        let row = (frame.bottom - frame.top) / self.bars.len() as f64;
        let zero = frame.at_x(0.0);
        for (index, bar) in self.bars.iter().enumerate() {
            let top = frame.top + row * index as f64;
            let half = 0.5 * (row - 6.0);
            let halves = [
                (bar.lower, VERMILLION, top + 3.0),
                (bar.higher, BLUE, top + 3.0 + half),
            ];
            for (value, colour, y) in halves {
                let letter = Letter::new(15.0, Weight::Regular, FAINT_INK);
                match value.filter(|v| v.is_finite()) {
                    Some(value) => {
                        let end = frame.at_x(value * unit.factor);
                        canvas.fill((zero.min(end), y), (zero.max(end), y + half), colour);
                    }
                    None => {
                        canvas.text_beside("-", (zero + 6.0, y + 0.5 * half), Align::Left, letter)
                    }
                }
            }
            let letter = Letter::new(20.0, Weight::Regular, INK);
            let name = shorten(&bar.name, Weight::Regular, 20.0, NAMES - 12.0);
            let anchor = (frame.left - 12.0, top + 0.5 * row);
            canvas.text_beside(&name, anchor, Align::Right, letter);
        }
        canvas.cell((zero - 1.0, frame.top), (zero + 1.0, frame.bottom), INK);
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &unit.label(&self.label));
    }
}
