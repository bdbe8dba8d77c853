//! A canvas as SVG. The program that shows the SVG sets its text.

use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle,
};
use realgap_core::font::Weight;
use realgap_core::{Error, Result};

use crate::canvas::{Align, Canvas, Mark, Point, Text, corners, on_grid};

/// SVG coordinates of plotters are whole numbers; this many to a unit.
const PER_UNIT: u32 = 10;
/// Font families: the embedded font first, then common ones.
const FAMILY: &str = "Roboto, Helvetica, Arial, sans-serif";

/// The picture as SVG.
///
/// # Errors
/// An error of the SVG writer of plotters; no picture is known to cause one.
pub fn svg(canvas: &Canvas, (width, height): (u32, u32)) -> Result<Vec<u8>> {
    let large = (width * PER_UNIT, height * PER_UNIT);
    let mut text = String::new();
    let mut backend = SVGBackend::with_string(&mut text, large);
    let whole = (f64::from(width), f64::from(height));
    let ground = Mark::Rectangle((0.0, 0.0), whole, RGBColor(255, 255, 255));
    std::iter::once(&ground)
        .chain(&canvas.marks)
        .try_for_each(|mark| draw(&mut backend, mark))
        .and_then(|()| backend.present().map_err(|failure| failure.to_string()))
        .map_err(|failure| Error::invalid(format!("cannot draw the picture: {failure}")))?;
    drop(backend);
    // plotters writes the fine coordinates as the size of the picture; only the view box should have them.
    let fine = format!("width=\"{}\" height=\"{}\"", large.0, large.1);
    let real = format!(
        "width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\" stroke-linecap=\"round\""
    );
    Ok(with_lengths(&text.replacen(&fine, &real, 1), canvas).into_bytes())
}

/// Gives every text the width that it has in the embedded font, whatever font the viewer uses instead.
fn with_lengths(svg: &str, canvas: &Canvas) -> String {
    const TEXT: &str = "<text ";
    let mut pieces = svg.split(TEXT);
    let mut all = pieces.next().unwrap_or_default().to_owned();
    let texts = canvas.marks.iter().filter_map(|mark| match mark {
        Mark::Text(text) => Some(text),
        _ => None,
    });
    for (piece, Text { text, letter, .. }) in pieces.zip(texts) {
        let length = (letter.width(text) * f64::from(PER_UNIT)).round();
        all += TEXT;
        if length > 0.0 {
            all += &format!("textLength=\"{length}\" lengthAdjust=\"spacingAndGlyphs\" ");
        }
        all += piece;
    }
    all
}

fn at(point: Point) -> (i32, i32) {
    on_grid(point, PER_UNIT)
}

fn draw(backend: &mut SVGBackend, mark: &Mark) -> std::result::Result<(), String> {
    match mark {
        &Mark::Rectangle(from, to, colour) => {
            let (a, b) = corners(from, to);
            backend.draw_rect(at(a), at(b), &ShapeStyle::from(colour).filled(), true)
        }
        Mark::Polygon(points, colour) => {
            let points: Vec<_> = points.iter().map(|&point| at(point)).collect();
            backend.fill_polygon(points, &ShapeStyle::from(*colour).filled())
        }
        &Mark::Disc(centre, radius, colour) => {
            let radius = (radius * f64::from(PER_UNIT)).round().max(1.0) as u32;
            backend.draw_circle(at(centre), radius, &ShapeStyle::from(colour).filled(), true)
        }
        Mark::Line(points, width, colour) => {
            let stroke = (width * f64::from(PER_UNIT)).round().max(1.0) as u32;
            let points: Vec<_> = points.iter().map(|&point| at(point)).collect();
            backend.draw_path(points, &ShapeStyle::from(*colour).stroke_width(stroke))
        }
        Mark::Text(text) => return draw_text(backend, text),
    }
    .map_err(|failure| failure.to_string())
}

fn draw_text(backend: &mut SVGBackend, text: &Text) -> std::result::Result<(), String> {
    // plotters divides the size of a font by 1.24 and moves its baseline down.
    const SIZE_PER_EM: f64 = 1.24;
    const TOP_TO_BASELINE_EM: f64 = 0.76;
    let Text { letter, anchor, .. } = text;
    let top = TOP_TO_BASELINE_EM * letter.size;
    let position = if text.upwards {
        (anchor.0 - top, anchor.1)
    } else {
        (anchor.0, anchor.1 - top)
    };
    let h_pos = match text.align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    };
    let style = match letter.weight {
        Weight::Regular => FontStyle::Normal,
        Weight::Bold => FontStyle::Bold,
    };
    let size = letter.size * SIZE_PER_EM * f64::from(PER_UNIT);
    let mut font = FontDesc::new(FontFamily::Name(FAMILY), size, style);
    if text.upwards {
        font = font.transform(FontTransform::Rotate270);
    }
    let colour = letter.colour.to_rgba();
    let style = TextStyle::from(font)
        .color(&colour)
        .pos(Pos::new(h_pos, VPos::Top));
    backend
        .draw_text(&text.text, &style, at(position))
        .map_err(|failure| failure.to_string())
}
