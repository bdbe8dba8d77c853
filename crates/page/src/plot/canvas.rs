//! Drawing in picture units (one pixel of the finished PNG), whatever plotters backend is behind.

use plotters::backend::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle,
};

use super::colour::line;
use super::font::{self, CAPITAL_HEIGHT_EM, Weight};
use realgap_core::{Error, Result};

/// A point in picture units, y downwards.
pub(super) type Point = (f64, f64);

/// What the backend does with lines and text; plotters' backends differ there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Medium {
    Pixels,
    Vector,
}

/// Where a text's anchor is, horizontally.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    pub width: f64,
    pub colour: RGBColor,
    /// Lengths of dash and gap.
    pub dash: Option<(f64, f64)>,
}

impl Stroke {
    pub(super) fn new(width: f64, colour: RGBColor) -> Self {
        let dash = None;
        Self {
            width,
            colour,
            dash,
        }
    }

    pub(super) fn dashed(self, dash: Option<(f64, f64)>) -> Self {
        Self { dash, ..self }
    }

    /// The line of this number in the order in which they are used.
    pub(super) fn of(index: usize, width: f64) -> Self {
        let (colour, dash) = line(index);
        Self::new(width, colour).dashed(dash)
    }
}

/// Size, weight and colour of a text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Letter {
    pub size: f64,
    pub weight: Weight,
    pub colour: RGBColor,
}

impl Letter {
    pub(super) fn new(size: f64, weight: Weight, colour: RGBColor) -> Self {
        Self {
            size,
            weight,
            colour,
        }
    }

    pub(super) fn width(&self, text: &str) -> f64 {
        font::text_width(text, self.weight, self.size)
    }
}

/// A drawing surface. The first failure is kept and reported by [`Canvas::finish`], so that drawing
/// code reads like a drawing.
pub(super) struct Canvas<B: DrawingBackend> {
    backend: B,
    medium: Medium,
    /// Backend coordinates are whole numbers; several of them to a unit keep lines smooth.
    per_unit: f64,
    failure: Option<String>,
}

impl<B: DrawingBackend> Canvas<B> {
    pub(super) fn new(backend: B, medium: Medium, per_unit: u32) -> Self {
        Self {
            backend,
            medium,
            per_unit: f64::from(per_unit),
            failure: None,
        }
    }

    /// Hands the picture over; the first failure of any drawing step is returned here.
    pub(super) fn finish(mut self) -> Result<()> {
        let presented = self.backend.present();
        self.keep(presented);
        match self.failure {
            None => Ok(()),
            Some(failure) => Err(Error::invalid(format!(
                "cannot draw the picture: {failure}"
            ))),
        }
    }

    fn keep<E: std::fmt::Display>(&mut self, outcome: std::result::Result<(), E>) {
        if let Err(failure) = outcome {
            self.failure.get_or_insert(failure.to_string());
        }
    }

    fn at(&self, (x, y): Point) -> (i32, i32) {
        // Far outside is as good as further outside, and cannot overflow plotters' arithmetic.
        let whole = |v: f64| (v * self.per_unit).round().clamp(-1e6, 1e6) as i32;
        (whole(x), whole(y))
    }

    /// A filled rectangle with its corners as given.
    pub(super) fn fill(&mut self, from: Point, to: Point, colour: RGBColor) {
        let style = ShapeStyle::from(colour).filled();
        let (a, b) = (self.at(from), self.at(to));
        let (a, b) = ((a.0.min(b.0), a.1.min(b.1)), (a.0.max(b.0), a.1.max(b.1)));
        let outcome = self.backend.draw_rect(a, b, &style, true);
        self.keep(outcome);
    }

    /// A filled rectangle whose edges are moved to whole pixels: neighbours meet without a seam.
    pub(super) fn cell(&mut self, from: Point, to: Point, colour: RGBColor) {
        let whole = |(x, y): Point| (x.round(), y.round());
        self.fill(whole(from), whole(to), colour);
    }

    /// A rectangle drawn with lines of `width` centred on its edges.
    pub(super) fn outline(&mut self, from: Point, to: Point, width: f64, colour: RGBColor) {
        let ((x0, y0), (x1, y1), half) = (from, to, width / 2.0);
        self.fill((x0 - half, y0 - half), (x1 + half, y0 + half), colour);
        self.fill((x0 - half, y1 - half), (x1 + half, y1 + half), colour);
        self.fill((x0 - half, y0 - half), (x0 + half, y1 + half), colour);
        self.fill((x1 - half, y0 - half), (x1 + half, y1 + half), colour);
    }

    /// A filled polygon.
    pub(super) fn polygon(&mut self, points: &[Point], colour: RGBColor) {
        let points: Vec<_> = points.iter().map(|&p| self.at(p)).collect();
        let style = ShapeStyle::from(colour).filled();
        let outcome = self.backend.fill_polygon(points, &style);
        self.keep(outcome);
    }

    /// A filled circle.
    pub(super) fn disc(&mut self, centre: Point, radius: f64, colour: RGBColor) {
        let centre = self.at(centre);
        let radius = (radius * self.per_unit).round().max(1.0) as u32;
        let style = ShapeStyle::from(colour).filled();
        let outcome = self.backend.draw_circle(centre, radius, &style, true);
        self.keep(outcome);
    }

    /// A circle drawn with a line of `width`.
    pub(super) fn ring(&mut self, centre: Point, radius: f64, width: f64, colour: RGBColor) {
        let points: Vec<Point> = (0..=48)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 48.0).sin_cos();
                (centre.0 + radius * cos, centre.1 + radius * sin)
            })
            .collect();
        self.path(&points, Stroke::new(width, colour));
    }

    /// A star with five points.
    pub(super) fn star(&mut self, centre: Point, radius: f64, colour: RGBColor) {
        let points: Vec<Point> = (0..10)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 10.0).sin_cos();
                let r = if i % 2 == 0 { radius } else { 0.45 * radius };
                (centre.0 + r * sin, centre.1 - r * cos)
            })
            .collect();
        self.polygon(&points, colour);
    }

    /// A line through `points`, with round corners and ends.
    pub(super) fn path(&mut self, points: &[Point], stroke: Stroke) {
        match stroke.dash {
            None => self.solid_path(points, stroke),
            Some(dash) => {
                for piece in dashes(points, dash) {
                    self.solid_path(&piece, stroke);
                }
            }
        }
    }

    fn solid_path(&mut self, points: &[Point], Stroke { width, colour, .. }: Stroke) {
        let mut kept: Vec<Point> = Vec::with_capacity(points.len());
        for (i, &point) in points.iter().enumerate() {
            // Steps far below a pixel cost time and size, and plotters draws them badly.
            let is_last = i + 1 == points.len();
            if kept
                .last()
                .is_none_or(|&last| is_last || distance(last, point) > 0.4)
            {
                kept.push(point);
            }
        }
        let stroke = (width * self.per_unit).round().max(1.0) as u32;
        let style = ShapeStyle::from(colour).stroke_width(stroke);
        let kept_at: Vec<_> = kept.iter().map(|&p| self.at(p)).collect();
        match self.medium {
            Medium::Vector => {
                let outcome = self.backend.draw_path(kept_at, &style);
                self.keep(outcome);
            }
            // plotters' own thick paths grow spikes at sharp corners: draw piece by piece, and
            // round off the joints.
            Medium::Pixels => {
                let half = width / 2.0;
                for pair in kept.windows(2) {
                    let length = distance(pair[0], pair[1]);
                    if length < 1e-9 {
                        continue;
                    }
                    let (x, y) = (
                        -(pair[1].1 - pair[0].1) / length * half,
                        (pair[1].0 - pair[0].0) / length * half,
                    );
                    let [a, b] = [pair[0], pair[1]];
                    let one = [(a.0 + x, a.1 + y), (b.0 + x, b.1 + y)];
                    let other = [(b.0 - x, b.1 - y), (a.0 - x, a.1 - y)];
                    self.polygon(&[one, other].concat(), colour);
                }
                for &point in &kept {
                    self.disc(point, half, colour);
                }
            }
        }
    }

    /// A horizontal text whose baseline starts, is centred or ends at `anchor`.
    pub(super) fn text(&mut self, text: &str, anchor: Point, align: Align, letter: Letter) {
        self.turned_text(text, anchor, align, letter, false);
    }

    /// Like [`Canvas::text`], with the middle of the capital letters at the height of `anchor`.
    pub(super) fn text_beside(&mut self, text: &str, anchor: Point, align: Align, letter: Letter) {
        let baseline = anchor.1 + CAPITAL_HEIGHT_EM * letter.size / 2.0;
        self.text(text, (anchor.0, baseline), align, letter);
    }

    /// A text that reads upwards, its baseline at the x of `anchor` and centred on its y.
    pub(super) fn text_upwards(&mut self, text: &str, anchor: Point, letter: Letter) {
        self.turned_text(text, anchor, Align::Centre, letter, true);
    }

    fn turned_text(
        &mut self,
        text: &str,
        anchor: Point,
        align: Align,
        letter: Letter,
        upwards: bool,
    ) {
        // Control characters have no glyph and are not allowed in SVG.
        let text = text.replace(char::is_control, " ");
        match self.medium {
            Medium::Pixels => self.raster_text(&text, anchor, align, letter, upwards),
            Medium::Vector => self.vector_text(&text, anchor, align, letter, upwards),
        }
    }

    fn raster_text(
        &mut self,
        text: &str,
        anchor: Point,
        align: Align,
        letter: Letter,
        upwards: bool,
    ) {
        let before = match align {
            Align::Left => 0.0,
            Align::Centre => letter.width(text) / 2.0,
            Align::Right => letter.width(text),
        };
        let (x, y) = if upwards {
            self.at((anchor.0, anchor.1 + before))
        } else {
            self.at((anchor.0 - before, anchor.1))
        };
        let mut outcome = Ok(());
        let backend = &mut self.backend;
        let size = letter.size * self.per_unit;
        font::rasterise(text, letter.weight, size, |dx, dy, coverage| {
            let at = if upwards {
                (x + dy, y - dx)
            } else {
                (x + dx, y + dy)
            };
            let colour = letter.colour.mix(coverage).to_backend_color();
            if let Err(failure) = backend.draw_pixel(at, colour) {
                outcome = Err(failure.to_string());
            }
        });
        self.keep(outcome);
    }

    fn vector_text(
        &mut self,
        text: &str,
        anchor: Point,
        align: Align,
        letter: Letter,
        upwards: bool,
    ) {
        // plotters divides the size by this, and moves the baseline down by that.
        const SIZE_PER_EM: f64 = 1.24;
        const TOP_TO_BASELINE_EM: f64 = 0.76;
        let top = TOP_TO_BASELINE_EM * letter.size;
        let position = if upwards {
            (anchor.0 - top, anchor.1)
        } else {
            (anchor.0, anchor.1 - top)
        };
        let h_pos = match align {
            Align::Left => HPos::Left,
            Align::Centre => HPos::Center,
            Align::Right => HPos::Right,
        };
        let style = match letter.weight {
            Weight::Regular => FontStyle::Normal,
            Weight::Bold => FontStyle::Bold,
        };
        let size = letter.size * SIZE_PER_EM * self.per_unit;
        let mut font = FontDesc::new(FontFamily::Name(font::SVG_FAMILY), size, style);
        if upwards {
            font = font.transform(FontTransform::Rotate270);
        }
        let colour = letter.colour.to_rgba();
        let style = TextStyle::from(font)
            .color(&colour)
            .pos(Pos::new(h_pos, VPos::Top));
        let position = self.at(position);
        let outcome = self.backend.draw_text(text, &style, position);
        self.keep(outcome);
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// Cuts a line into dashes.
fn dashes(points: &[Point], (dash, gap): (f64, f64)) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Point> = points.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, dash);
    for pair in points.windows(2) {
        let length = distance(pair[0], pair[1]);
        let mut gone = 0.0;
        while length - gone > left {
            gone += left;
            let share = gone / length;
            let here = (
                pair[0].0 + (pair[1].0 - pair[0].0) * share,
                pair[0].1 + (pair[1].1 - pair[0].1) * share,
            );
            if drawing {
                piece.push(here);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![here];
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length - gone;
        if drawing {
            piece.push(pair[1]);
        }
    }
    if drawing && !piece.is_empty() {
        pieces.push(piece);
    }
    pieces
}
