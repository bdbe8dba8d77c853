//! The embedded font, so that a picture has the same bytes on every machine.
//!
//! Letters are set here and not by plotters, which (0.3.7) leaves out the space that a letter has
//! on its left, so that they come out unevenly spaced.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

use crate::{Error, Result};

/// The family for SVG, whose text is set by the viewer: the embedded font first, then what is common.
pub(super) const SVG_FAMILY: &str = "Roboto, Helvetica, Arial, sans-serif";
/// Height of a capital letter, as a share of the em.
pub(super) const CAPITAL_HEIGHT_EM: f64 = 0.711;

const REGULAR: &[u8] = include_bytes!("../../assets/font/Roboto-Regular.ttf");
const BOLD: &[u8] = include_bytes!("../../assets/font/Roboto-Bold.ttf");

/// Weight of the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
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

/// Fails if the embedded font cannot be read; after this, texts are not silently missing.
pub(super) fn check() -> Result<()> {
    if face(Weight::Regular).is_some() && face(Weight::Bold).is_some() {
        Ok(())
    } else {
        Err(Error::invalid("the embedded font cannot be read")
            .hint("this is a fault of realgap; please report it"))
    }
}

/// ab_glyph scales to the height from descent to ascent where people say "font size".
fn scale(face: &FontRef<'static>, size: f64) -> PxScale {
    let per_em = face.height_unscaled() / face.units_per_em().unwrap_or(2048.0);
    PxScale::from(size as f32 * per_em)
}

/// Width of `text` in pixels at `size` pixels per em.
pub(super) fn text_width(text: &str, weight: Weight, size: f64) -> f64 {
    let Some(face) = face(weight) else {
        return 0.0;
    };
    let scaled = face.as_scaled(scale(face, size));
    text.chars()
        .map(|c| f64::from(scaled.h_advance(face.glyph_id(c))))
        .sum()
}

/// Calls `dot(x, y, coverage)` for every pixel of `text`, with the start of the baseline at (0, 0).
pub(super) fn rasterise(text: &str, weight: Weight, size: f64, mut dot: impl FnMut(i32, i32, f64)) {
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

/// `text`, shortened with an ellipsis where it is wider than `width`.
pub(super) fn shorten(text: &str, weight: Weight, size: f64, width: f64) -> String {
    if text_width(text, weight, size) <= width {
        return text.to_string();
    }
    let mut kept: Vec<char> = text.chars().collect();
    loop {
        // Long texts first lose what surely does not fit, so that this stays cheap.
        let step = (kept.len() / 20).max(1);
        kept.truncate(kept.len() - step.min(kept.len()));
        let candidate = format!("{}…", kept.iter().collect::<String>().trim_end());
        if kept.is_empty() || text_width(&candidate, weight, size) <= width {
            return candidate;
        }
    }
}

/// `text` in lines no wider than `width`, broken at blanks; at most `lines`, the last one shortened.
pub(super) fn wrap(text: &str, weight: Weight, size: f64, width: f64, lines: usize) -> Vec<String> {
    let mut done: Vec<String> = Vec::new();
    let mut current = String::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(word) = words.next() {
        let longer = if current.is_empty() {
            word.to_string()
        } else {
            format!("{current} {word}")
        };
        if current.is_empty() || text_width(&longer, weight, size) <= width {
            current = longer;
        } else if done.len() + 1 == lines {
            current = longer;
            for rest in words.by_ref() {
                current.push(' ');
                current.push_str(rest);
            }
        } else {
            done.push(std::mem::replace(&mut current, word.to_string()));
        }
    }
    if !current.is_empty() {
        done.push(current);
    }
    done.iter()
        .map(|line| shorten(line, weight, size, width))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_keeps_every_line_within_the_width() {
        check().unwrap();
        let text = "a rather long title that has to go somewhere and anundividablewordthatislongerthanaline";
        let lines = wrap(text, Weight::Bold, 28.0, 300.0, 3);
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert!(text_width(line, Weight::Bold, 28.0) <= 300.0, "{line}");
        }
        assert!(lines[2].ends_with('…'));
        assert!(wrap("", Weight::Bold, 28.0, 300.0, 3).is_empty());
    }
}
