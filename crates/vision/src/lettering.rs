//! Draws printed text as a picture, for learning pictures, posters and tests.

use super::picture::Grey;
use realgap_core::error::Result;
use realgap_core::font::{self, Weight};

/// Distance between lines, and margin around the text, in multiples of the size of letters.
const LINE_EM: f64 = 1.4;
const MARGIN_EM: f64 = 0.6;

/// Draws black letters on white, with `size_px` pixels to an em and `tracking_em` additional space between letters. A character that
/// the font does not have leaves a gap.
///
/// ```
/// use realgap_vision::print_text;
///
/// let sign = print_text("EXIT LEFT\n42", 40.0, 0.05)?;
/// assert!(sign.width() > sign.height());
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// A picture of more than 32 megapixels.
pub fn print_text(text: &str, size_px: f64, tracking_em: f64) -> Result<Grey> {
    font::check()?;
    let advance = |c: char| {
        font::text_width(c.encode_utf8(&mut [0; 4]), Weight::Regular, size_px)
            + tracking_em * size_px
    };
    let lines: Vec<&str> = text.lines().collect();
    let widest = lines
        .iter()
        .map(|line| line.chars().map(advance).sum())
        .fold(0.0_f64, f64::max);
    let side = |em: f64, more: f64| ((em * size_px + more).ceil().max(1.0)) as usize;
    let (width, height) = (
        side(2.0 * MARGIN_EM, widest),
        side(2.0 * MARGIN_EM + LINE_EM * lines.len() as f64, 0.0),
    );
    super::picture::check_size(width, height)?;
    let mut values = vec![1.0_f32; width * height];
    for (index, line) in lines.iter().enumerate() {
        let baseline = (MARGIN_EM + LINE_EM * index as f64 + 1.0) * size_px;
        let mut x = MARGIN_EM * size_px;
        for c in line.chars() {
            let (left, top) = (x.round() as i32, baseline.round() as i32);
            let letter = c.encode_utf8(&mut [0; 4]).to_owned();
            font::rasterise(&letter, Weight::Regular, size_px, |dx, dy, coverage| {
                let (column, row) = (left + dx, top + dy);
                let is_inside =
                    column >= 0 && row >= 0 && column < width as i32 && row < height as i32;
                if is_inside {
                    let value = &mut values[row as usize * width + column as usize];
                    *value = value.min(1.0 - coverage as f32);
                }
            });
            x += advance(c);
        }
    }
    Grey::new(width, height, values)
}
