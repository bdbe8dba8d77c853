//! The embedded font, which turns text into pixel coverage in the same way on every machine.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

use crate::Error;
use crate::Result;

/// Height of a capital letter, as a share of the em.
pub const CAPITAL_HEIGHT_EM: f64 = 0.711;

const REGULAR: &[u8] = include_bytes!("../assets/font/Roboto-Regular.ttf");
const BOLD: &[u8] = include_bytes!("../assets/font/Roboto-Bold.ttf");

/// Weight of the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// Upright letters of usual weight.
    Regular,
    /// Bold letters.
    Bold,
}

fn face(weight: Weight) -> Option<&'static FontRef<'static>> {
    static FACES: [OnceLock<Option<FontRef<'static>>>; 2] = [OnceLock::new(), OnceLock::new()];
    let (face, bytes) = match weight {
        Weight::Regular => (&FACES[0], REGULAR),
        Weight::Bold => (&FACES[1], BOLD),
    };
    face.get_or_init(|| FontRef::try_from_slice(bytes).ok())
        .as_ref()
}

/// Fails if the embedded font cannot be read. Programs call this first, because drawing functions leave texts out without an error.
pub fn check() -> Result<()> {
    if face(Weight::Regular).is_some() && face(Weight::Bold).is_some() {
        Ok(())
    } else {
        Err(Error::invalid("the embedded font cannot be read")
            .hint("this is a fault of realgap; please report it"))
    }
}

/// The scale for a font size in pixels per em; ab_glyph instead measures the height from descent to ascent.
fn scale(face: &FontRef<'static>, size: f64) -> PxScale {
    let per_em = face.height_unscaled() / face.units_per_em().unwrap_or(2048.0);
    PxScale::from(size as f32 * per_em)
}

/// Width of `text` in pixels at `size` pixels per em.
pub fn text_width(text: &str, weight: Weight, size: f64) -> f64 {
    let Some(face) = face(weight) else {
        return 0.0;
    };
    let scaled = face.as_scaled(scale(face, size));
    text.chars()
        .map(|c| f64::from(scaled.h_advance(face.glyph_id(c))))
        .sum()
}

/// Calls `dot(x, y, coverage)` for every pixel of `text`, with the start of the baseline at (0, 0).
pub fn rasterise(text: &str, weight: Weight, size: f64, mut dot: impl FnMut(i32, i32, f64)) {
    let Some(face) = face(weight) else {
        return;
    };
    let scale = scale(face, size);
    let scaled = face.as_scaled(scale);
    let mut x = 0.0;
    for id in text.chars().map(|c| face.glyph_id(c)) {
        let glyph = id.with_scale_and_position(scale, point(x, 0.0));
        x += scaled.h_advance(id);
        if let Some(outline) = face.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|dx, dy, coverage| {
                dot(
                    corner.x as i32 + dx as i32,
                    corner.y as i32 + dy as i32,
                    f64::from(coverage.clamp(0.0, 1.0)),
                );
            });
        }
    }
}
