//! A canvas: a list of marks in the order in which they are drawn.

use plotters::style::RGBColor;
use realgap_core::font::{CAPITAL_HEIGHT_EM, Weight, text_width};

/// A point in picture units, y downwards.
pub type Point = (f64, f64);

/// Where a text's anchor is, horizontally.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// The text begins there.
    Left,
    /// Its middle is there.
    Centre,
    /// The text ends there.
    Right,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its width in picture units.
    pub width: f64,
    /// Its colour.
    pub colour: RGBColor,
    /// Lengths of dash and gap.
    pub dash: Option<(f64, f64)>,
}

impl Stroke {
    /// A line without dashes.
    pub fn new(width: f64, colour: RGBColor) -> Self {
        let dash = None;
        Self {
            width,
            colour,
            dash,
        }
    }

    /// The same line with these lengths of dash and gap.
    pub fn dashed(self, dash: Option<(f64, f64)>) -> Self {
        Self { dash, ..self }
    }
}

/// Size, weight and colour of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Letter {
    /// The height of an em in picture units.
    pub size: f64,
    /// Regular or bold.
    pub weight: Weight,
    /// Its colour.
    pub colour: RGBColor,
}

impl Letter {
    /// Letters of this kind.
    pub fn new(size: f64, weight: Weight, colour: RGBColor) -> Self {
        Self {
            size,
            weight,
            colour,
        }
    }

    /// How wide this text is in picture units.
    pub fn width(&self, text: &str) -> f64 {
        text_width(text, self.weight, self.size)
    }
}

/// One thing on a canvas.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mark {
    /// A filled rectangle between two corners.
    Rectangle(Point, Point, RGBColor),
    /// A filled polygon.
    Polygon(Vec<Point>, RGBColor),
    /// A filled circle.
    Disc(Point, f64, RGBColor),
    /// A line without dashes and its width.
    Line(Vec<Point>, f64, RGBColor),
    /// A text and its anchor.
    Text(Text),
}

/// A text in one line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    pub text: String,
    pub anchor: Point,
    pub align: Align,
    pub letter: Letter,
    pub upwards: bool,
}

/// A white drawing surface; what is drawn later lies above.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Canvas {
    pub(crate) marks: Vec<Mark>,
}

impl Canvas {
    /// A filled rectangle with its corners as given.
    pub fn fill(&mut self, from: Point, to: Point, colour: RGBColor) {
        self.marks.push(Mark::Rectangle(from, to, colour));
    }

    /// A filled rectangle whose edges are rounded to whole pixels, so that neighbours meet without a seam.
    pub fn cell(&mut self, from: Point, to: Point, colour: RGBColor) {
        let whole = |(x, y): Point| (x.round(), y.round());
        self.fill(whole(from), whole(to), colour);
    }

    /// A rectangle drawn with lines of `width` centred on its edges.
    pub fn outline(&mut self, from: Point, to: Point, width: f64, colour: RGBColor) {
        let ((x0, y0), (x1, y1), half) = (from, to, width / 2.0);
        self.fill((x0 - half, y0 - half), (x1 + half, y0 + half), colour);
        self.fill((x0 - half, y1 - half), (x1 + half, y1 + half), colour);
        self.fill((x0 - half, y0 - half), (x0 + half, y1 + half), colour);
        self.fill((x1 - half, y0 - half), (x1 + half, y1 + half), colour);
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[Point], colour: RGBColor) {
        self.marks.push(Mark::Polygon(points.to_vec(), colour));
    }

    /// A filled circle.
    pub fn disc(&mut self, centre: Point, radius: f64, colour: RGBColor) {
        self.marks.push(Mark::Disc(centre, radius, colour));
    }

    /// A circle drawn with a line of `width`.
    pub fn ring(&mut self, centre: Point, radius: f64, width: f64, colour: RGBColor) {
        let points: Vec<Point> = (0..=48)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 48.0).sin_cos();
                (centre.0 + radius * cos, centre.1 + radius * sin)
            })
            .collect();
        self.path(&points, Stroke::new(width, colour));
    }

    /// A star with five points.
    pub fn star(&mut self, centre: Point, radius: f64, colour: RGBColor) {
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
    pub fn path(&mut self, points: &[Point], stroke: Stroke) {
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
            // Steps far below a pixel cost time and file size, and plotters draws them badly.
            let is_last = i + 1 == points.len();
            if kept
                .last()
                .is_none_or(|&last| is_last || distance(last, point) > 0.4)
            {
                kept.push(point);
            }
        }
        self.marks.push(Mark::Line(kept, width, colour));
    }

    /// A horizontal text whose baseline starts, is centred or ends at `anchor`.
    pub fn text(&mut self, text: &str, anchor: Point, align: Align, letter: Letter) {
        self.turned_text(text, anchor, align, letter, false);
    }

    /// Like [`Canvas::text`], with the middle of the capital letters at the height of `anchor`.
    pub fn text_beside(&mut self, text: &str, anchor: Point, align: Align, letter: Letter) {
        let baseline = anchor.1 + CAPITAL_HEIGHT_EM * letter.size / 2.0;
        self.text(text, (anchor.0, baseline), align, letter);
    }

    /// A text that reads upwards, its baseline at the x of `anchor` and centred on its y.
    pub fn text_upwards(&mut self, text: &str, anchor: Point, letter: Letter) {
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
        self.marks.push(Mark::Text(Text {
            text,
            anchor,
            align,
            letter,
            upwards,
        }));
    }
}

/// A point on a grid with so many steps to a unit.
pub(crate) fn on_grid((x, y): Point, per_unit: u32) -> (i32, i32) {
    // Coordinates far outside of the picture are clamped, because they would overflow the integers of plotters.
    let whole = |v: f64| (v * f64::from(per_unit)).round().clamp(-1e6, 1e6) as i32;
    (whole(x), whole(y))
}

/// The upper left and the lower right corner of a rectangle.
pub(crate) fn corners(a: Point, b: Point) -> (Point, Point) {
    ((a.0.min(b.0), a.1.min(b.1)), (a.0.max(b.0), a.1.max(b.1)))
}

pub(crate) fn distance(a: Point, b: Point) -> f64 {
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
