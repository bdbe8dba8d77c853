//! The embedded font, so that a picture has the same bytes on every machine.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use crate::{Error, Result};

/// The name under which the font is registered; an SVG viewer reads it as a list of fallbacks.
const FAMILY: &str = "Roboto, Helvetica, Arial, sans-serif";
const REGULAR: &[u8] = include_bytes!("../../assets/font/Roboto-Regular.ttf");
const BOLD: &[u8] = include_bytes!("../../assets/font/Roboto-Bold.ttf");

/// Height of a capital letter, as a share of the em.
pub(super) const CAPITAL_HEIGHT_EM: f64 = 0.711;
/// plotters wants the height of a line from ascent to descent where people say "font size".
pub(super) const LINE_HEIGHT_EM: f64 = (1900.0 + 500.0) / 2048.0;

/// Size at which text is measured: plotters rounds widths to whole pixels, so measure large.
const MEASURE_SIZE: f64 = 1000.0;

/// Weight of the letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
    Bold,
}

/// Makes the font known to plotters, once per process.
pub(super) fn register() -> Result<()> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = *REGISTERED.get_or_init(|| {
        register_font(FAMILY, FontStyle::Normal, REGULAR).is_ok()
            && register_font(FAMILY, FontStyle::Bold, BOLD).is_ok()
    });
    if registered {
        Ok(())
    } else {
        Err(Error::invalid("the embedded font cannot be read")
            .hint("this is a fault of realgap; please report it"))
    }
}

/// The font with `size` in plotters' meaning.
pub(super) fn font(weight: Weight, size: f64) -> FontDesc<'static> {
    let style = match weight {
        Weight::Regular => FontStyle::Normal,
        Weight::Bold => FontStyle::Bold,
    };
    FontDesc::new(FontFamily::Name(FAMILY), size, style)
}

/// Width of `text` in pixels at `size` pixels per em.
pub(super) fn text_width(text: &str, weight: Weight, size: f64) -> f64 {
    let layout = font(weight, MEASURE_SIZE * LINE_HEIGHT_EM).layout_box(text);
    // The font is registered before anything is measured; the estimate is a second safety net.
    let width = layout.map_or(
        0.55 * MEASURE_SIZE * text.chars().count() as f64,
        |((left, _), (right, _))| f64::from(right - left),
    );
    width / MEASURE_SIZE * size
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
        register().unwrap();
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
