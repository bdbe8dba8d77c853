//! Overlay: aligned trajectories in one plot, as `compare --plot` shows them.

use crate::plot::kit::*;

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
    picture::write(overlay, path.as_ref())
}

impl Overlay {
    fn above(&self) -> Above {
        let all = std::iter::once(&self.reference).chain(&self.others);
        Above::new(all.map(|path| &path.points_m), SHAPE, WIDTH, MARGIN)
    }

    fn heading_and_legend(&self) -> HeadingAndLegend {
        let discrepancies = self.others.iter().filter_map(|path| path.discrepancy);
        let unit = DisplayUnit::for_values(self.unit, discrepancies);
        let text = |path: &OverlayPath| match path.discrepancy {
            Some(value) => format!("{}: {}", path.name, unit.format(value)),
            None => path.name.clone(),
        };
        let name = &self.reference.name;
        let name = match self.others.as_slice() {
            [] => name.clone(),
            _ => format!("{name} (reference)"),
        };
        let mut entries = vec![(Symbol::Line(Stroke::new(5.0, INK)), name)];
        for (index, path) in self.others.iter().enumerate().take(LEGEND_ENTRIES) {
            entries.push((Symbol::Line(stroke_of(index, 3.5)), text(path)));
        }
        entries.push((Symbol::Start, "start".to_string()));
        if let Some(more @ 1..) = self.others.len().checked_sub(LEGEND_ENTRIES) {
            entries.push((Symbol::Shade(WHITE), format!("… and {more} more")));
        }
        HeadingAndLegend::new(&self.caption, entries, WIDTH, MARGIN)
    }
}

impl Picture for Overlay {
    fn check(&self) -> Result<()> {
        if self.reference.points_m.is_empty() && self.others.is_empty() {
            return Err(Error::invalid("there is no trajectory to draw"));
        }
        Ok(())
    }

    fn size(&self) -> (u32, u32) {
        let room = self.above().height + BELOW_LABEL;
        self.heading_and_legend().around(WIDTH, room)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (surround, above) = (self.heading_and_legend(), self.above());
        let top = surround.top().round();
        surround.draw_around(canvas, top + above.height + BELOW_LABEL);
        above.draw(canvas, top, "x (cm)", |canvas, frame| {
            let black = Stroke::new(5.0, INK);
            draw_path(canvas, frame, &self.reference.points_m, black);
            for (index, path) in self.others.iter().enumerate() {
                draw_path(canvas, frame, &path.points_m, stroke_of(index, 3.0));
            }
        });
    }
}
