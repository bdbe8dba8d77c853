//! Curve: the score over one parameter.

use std::path::Path;

use plotters::backend::DrawingBackend;

use super::axis::{self, AxisSpec, Truth, check_length, check_values, edges};
use super::canvas::{Align, Canvas, Letter};
use super::colour::{BLUE, FAINT_INK, SHADE, VERMILLION, WHITE};
use super::font::Weight;
use super::frame::{BELOW_LABEL, Frame, left_of_label};
use super::heading::{Caption, Heading};
use super::legend::{Legend, Symbol, draw_cross, draw_star};
use super::picture::{self, Picture};
use super::scale::{AXIS_DECADES, Scale, ScoreScale, with_room};
use realgap_core::Error;
use realgap_core::Result;
use realgap_core::unit::DisplayUnit;
use realgap_core::unit::Unit;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 800.0;
const MARGIN: f64 = 34.0;
/// Height of the strip at the top of the frame in which diverged points are marked.
const STRIP: f64 = 34.0;

/// A score over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The parameter.
    pub x: AxisSpec,
    /// Values of the parameter, strictly increasing.
    pub x_values: Vec<f64>,
    /// The score at each value; `None` (and anything not finite) is a diverged simulation.
    pub scores: Vec<Option<f64>>,
    /// What the score is, e.g. `PCA discrepancy`.
    pub score_label: String,
    /// Unit in which the scores are given; they are shown in one of handy size.
    pub score_unit: Unit,
    /// How scores become heights; the label of the axis says so.
    pub scale: ScoreScale,
    /// Index of the best point.
    pub best: Option<usize>,
    /// Points that cannot be told from the best; empty for none.
    pub indistinguishable: Vec<bool>,
    /// The true value, where it is known.
    pub truth: Option<Truth>,
}

/// Draws a curve into a PNG or SVG file.
pub fn draw_curve(curve: &Curve, path: impl AsRef<Path>) -> Result<()> {
    curve.check()?;
    picture::write(curve, path.as_ref())
}

impl Curve {
    fn check(&self) -> Result<()> {
        check_values("x_values", &self.x_values)?;
        check_length("scores", self.scores.len(), self.x_values.len())?;
        if !self.indistinguishable.is_empty() {
            check_length(
                "indistinguishable",
                self.indistinguishable.len(),
                self.x_values.len(),
            )?;
        }
        match self.best {
            Some(best) if best >= self.x_values.len() => {
                Err(Error::invalid("the best point lies outside the values")
                    .field("best")
                    .found(best)
                    .allowed(format!("up to {}", self.x_values.len() - 1)))
            }
            _ => Ok(()),
        }
    }

    fn score(&self, index: usize) -> Option<f64> {
        self.scores[index].filter(|score| score.is_finite())
    }

    fn legend(&self, diverged: usize, unit: DisplayUnit) -> Legend {
        let mut entries = Vec::new();
        if let Some(best) = self.best {
            let score = self
                .score(best)
                .map_or("diverged".to_string(), |score| unit.format(score));
            let place = self.x.at(self.x_values[best]);
            entries.push((Symbol::Star, format!("best: {score} at {place}")));
        }
        let inside = self
            .indistinguishable
            .iter()
            .filter(|&&inside| inside)
            .count();
        if inside > 0 {
            let text = format!(
                "cannot be told from the best ({inside} of {})",
                self.scores.len()
            );
            entries.push((Symbol::Shade(SHADE), text));
        }
        if diverged > 0 {
            entries.push((Symbol::Cross, format!("diverged ({diverged})")));
        }
        if let Some(truth) = &self.truth {
            let line = Symbol::Line {
                colour: VERMILLION,
                width: 3.0,
                dash: Some((10.0, 7.0)),
            };
            entries.push((line, format!("{}: {}", truth.label, self.x.at(truth.x))));
        }
        Legend::new(entries, WIDTH - 2.0 * MARGIN)
    }

    fn draw_shade<B: DrawingBackend>(&self, canvas: &mut Canvas<B>, frame: &Frame) {
        let edges = edges(&self.x_values);
        for (index, _) in self
            .indistinguishable
            .iter()
            .enumerate()
            .filter(|(_, inside)| **inside)
        {
            let at = |edge: f64| frame.at_x(edge).clamp(frame.left, frame.right);
            canvas.cell(
                (at(edges[index]), frame.top),
                (at(edges[index + 1]), frame.bottom),
                SHADE,
            );
        }
    }

    fn draw_scores<B: DrawingBackend>(&self, canvas: &mut Canvas<B>, frame: &Frame, factor: f64) {
        let point = |index: usize| {
            self.score(index).map(|score| {
                let share = frame.y.share(score * factor).clamp(0.0, 1.0);
                let y = frame.bottom - share * (frame.bottom - frame.top);
                (frame.at_x(self.x_values[index]), y)
            })
        };
        let points: Vec<_> = (0..self.scores.len()).map(point).collect();
        // A diverged point interrupts the line: nothing is known there.
        for run in points.split(Option::is_none) {
            let run: Vec<_> = run.iter().flatten().copied().collect();
            canvas.path(&run, 3.5, BLUE, None);
        }
        if points.len() <= 80 {
            for &point in points.iter().flatten() {
                canvas.disc(point, 6.5, WHITE);
                canvas.disc(point, 5.0, BLUE);
            }
        }
        if let Some(point) = self.best.and_then(|best| points[best]) {
            draw_star(canvas, point);
        }
    }
}

impl Picture for Curve {
    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, HEIGHT as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<B>) {
        let finite: Vec<f64> = (0..self.scores.len())
            .filter_map(|i| self.score(i))
            .collect();
        let diverged = self.scores.len() - finite.len();
        let unit = DisplayUnit::for_values(self.score_unit, finite.iter().copied());
        let shown: Vec<f64> = finite.iter().map(|score| score * unit.factor).collect();
        let y = with_room(Scale::for_scores(&shown, self.scale, AXIS_DECADES));

        let heading = Heading::new(&self.caption, WIDTH - 2.0 * MARGIN);
        heading.draw(canvas, MARGIN, 14.0);
        let legend = self.legend(diverged, unit);
        let legend_top = HEIGHT - 16.0 - legend.height();
        legend.draw(canvas, MARGIN, legend_top);

        let x_edges = edges(&self.x_values);
        let x = Scale::linear(x_edges[0], x_edges[x_edges.len() - 1]);
        let x_ticks = axis::ticks(&self.x, &self.x_values, &x, 9);
        let y_ticks = if finite.is_empty() {
            Vec::new()
        } else {
            y.ticks(7)
        };
        let strip = if diverged > 0 { STRIP } else { 0.0 };
        let frame = Frame {
            left: MARGIN + left_of_label(&y_ticks),
            top: 14.0 + heading.height() + 22.0 + strip,
            right: WIDTH - MARGIN,
            bottom: legend_top - 14.0 - BELOW_LABEL,
            x,
            y,
        };
        let whole = Frame {
            top: frame.top - strip,
            ..frame
        };
        self.draw_shade(canvas, &whole);
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        if let Some(truth) = &self.truth
            && (0.0..=1.0).contains(&frame.x.share(truth.x))
        {
            let x = frame.at_x(truth.x);
            let line = [(x, whole.top), (x, whole.bottom)];
            canvas.path(&line, 3.0, VERMILLION, Some((10.0, 7.0)));
        }
        let mut free_from = f64::NEG_INFINITY;
        for index in (0..self.scores.len()).filter(|&i| self.score(i).is_none()) {
            let x = frame.at_x(self.x_values[index]);
            // A dense row of crosses is as clear as a complete one, and can be read.
            if x >= free_from {
                draw_cross(canvas, (x, whole.top + STRIP / 2.0));
                free_from = x + 20.0;
            }
        }
        self.draw_scores(canvas, &frame, unit.factor);
        whole.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, &self.x.title());
        let label = format!("{}{}", unit.label(&self.score_label), y.remark());
        frame.draw_y_axis(canvas, &y_ticks, &label);
        if finite.is_empty() {
            let centre = (
                (frame.left + frame.right) / 2.0,
                (frame.top + frame.bottom) / 2.0,
            );
            let (x, y) = centre;
            canvas.cell((x - 210.0, y - 30.0), (x + 210.0, y + 30.0), WHITE);
            let letter = Letter::new(28.0, Weight::Bold, FAINT_INK);
            canvas.text_beside("every simulation diverged", centre, Align::Centre, letter);
        }
    }
}
