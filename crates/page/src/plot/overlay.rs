//! Overlay: aligned trajectories in one plot, as `compare --plot` shows them.

use std::path::Path;

use plotters::backend::DrawingBackend;

use super::canvas::Canvas;
use super::colour::{self, INK};
use super::frame::{BELOW_LABEL, Frame, left_of_label};
use super::heading::{Caption, Heading};
use super::legend::{Legend, Symbol, draw_start};
use super::path::{PathPoint, bounds_cm, draw_path, equal_aspect, finite_cm};
use super::picture::{self, Picture};
use realgap_core::Error;
use realgap_core::Result;
use realgap_core::unit::DisplayUnit;
use realgap_core::unit::Unit;

const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 34.0;
/// Height of the frame as a share of its width.
const SHAPE: std::ops::RangeInclusive<f64> = 0.3..=0.85;
/// More names than this would crowd out the picture.
const LEGEND_ENTRIES: usize = 24;

/// One trajectory of an overlay.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayPath {
    /// Its name, e.g. the stem of the file.
    pub name: String,
    /// Its distance from the reference, in the unit of the overlay; `None` where there is none.
    pub discrepancy: Option<f64>,
    /// Its points after preparation, in metres.
    pub points_m: Vec<PathPoint>,
}

/// Aligned trajectories over each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// What is shown, and where it comes from.
    pub caption: Caption,
    /// The trajectory the others are compared with; drawn black.
    pub reference: OverlayPath,
    /// The others, in the order of the legend.
    pub others: Vec<OverlayPath>,
    /// Unit of the discrepancies.
    pub unit: Unit,
}

/// Draws an overlay into a PNG or SVG file.
pub fn draw_overlay(overlay: &Overlay, path: impl AsRef<Path>) -> Result<()> {
    if overlay.reference.points_m.is_empty() && overlay.others.is_empty() {
        return Err(Error::invalid("there is no trajectory to draw"));
    }
    picture::write(overlay, path.as_ref())
}

impl Overlay {
    fn layout(&self) -> (Heading, Legend, f64) {
        let width = WIDTH - 2.0 * MARGIN;
        let (x, y) = self.bounds();
        let shape = (y.1 - y.0) / (x.1 - x.0);
        let frame_height = (width - 70.0) * shape.clamp(*SHAPE.start(), *SHAPE.end());
        (
            Heading::new(&self.caption, width),
            self.legend(width),
            frame_height.round(),
        )
    }

    fn bounds(&self) -> ((f64, f64), (f64, f64)) {
        let all = std::iter::once(&self.reference).chain(&self.others);
        bounds_cm(all.map(|path| path.points_m.as_slice()))
    }

    fn legend(&self, width: f64) -> Legend {
        let discrepancies = self.others.iter().filter_map(|path| path.discrepancy);
        let unit = DisplayUnit::for_values(self.unit, discrepancies);
        let text = |path: &OverlayPath| match path.discrepancy {
            Some(value) => format!("{}: {}", path.name, unit.format(value)),
            None => path.name.clone(),
        };
        let reference = Symbol::Line {
            colour: INK,
            width: 5.0,
            dash: None,
        };
        let name = &self.reference.name;
        let name = match self.others.as_slice() {
            [] => name.clone(),
            _ => format!("{name} (reference)"),
        };
        let mut entries = vec![(reference, name)];
        for (index, path) in self.others.iter().enumerate().take(LEGEND_ENTRIES) {
            let (colour, dash) = colour::line(index);
            let symbol = Symbol::Line {
                colour,
                width: 3.5,
                dash,
            };
            entries.push((symbol, text(path)));
        }
        entries.push((Symbol::Start, "start".to_string()));
        if let Some(more @ 1..) = self.others.len().checked_sub(LEGEND_ENTRIES) {
            entries.push((Symbol::Shade(colour::WHITE), format!("… and {more} more")));
        }
        Legend::new(entries, width)
    }
}

/// A tick for every so many pixels of height.
fn tick_count(height: f64) -> usize {
    (height / 65.0).clamp(3.0, 8.0) as usize
}

impl Picture for Overlay {
    fn size(&self) -> (u32, u32) {
        let (heading, legend, frame_height) = self.layout();
        let height = 14.0
            + heading.height()
            + 22.0
            + frame_height
            + BELOW_LABEL
            + 14.0
            + legend.height()
            + 16.0;
        (WIDTH as u32, height.ceil() as u32)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<B>) {
        let (heading, legend, frame_height) = self.layout();
        heading.draw(canvas, MARGIN, 14.0);
        let top = (14.0 + heading.height() + 22.0).round();
        let bottom = top + frame_height;
        let (x, y) = self.bounds();
        // The width of the labels depends on the range and the range on the frame: one round is
        // enough, as only the number of digits matters.
        let (_, rough) = equal_aspect(x, y, (WIDTH - 2.0 * MARGIN - 70.0) / frame_height);
        let left = MARGIN + left_of_label(&rough.ticks(tick_count(frame_height))).round();
        let right = WIDTH - MARGIN;
        let (x, y) = equal_aspect(x, y, (right - left) / frame_height);
        let frame = Frame {
            left,
            top,
            right,
            bottom,
            x,
            y,
        };
        let (x_ticks, y_ticks) = (x.ticks(9), y.ticks(tick_count(frame_height)));
        frame.draw_grid(canvas, &x_ticks, &y_ticks);
        draw_path(
            canvas,
            &frame,
            &finite_cm(&self.reference.points_m),
            5.0,
            INK,
            None,
        );
        for (index, path) in self.others.iter().enumerate() {
            let (colour, dash) = colour::line(index);
            draw_path(
                canvas,
                &frame,
                &finite_cm(&path.points_m),
                3.0,
                colour,
                dash,
            );
        }
        draw_start(canvas, frame.at((0.0, 0.0)));
        frame.draw_outline(canvas);
        frame.draw_x_axis(canvas, &x_ticks, "x (cm)");
        frame.draw_y_axis(canvas, &y_ticks, "y (cm)");
        legend.draw(canvas, MARGIN, bottom + BELOW_LABEL + 14.0);
    }
}
