//! Setting text in a picture with the embedded font.
//!
//! Letters are set here and not by plotters, which (0.3.7) leaves out the space that a letter has
//! on its left, so that they come out unevenly spaced.

pub(in crate::plot) use realgap_core::font::{Weight, check, text_width};

/// `text`, shortened with an ellipsis where it is wider than `width`.
pub(in crate::plot) fn shorten(text: &str, weight: Weight, size: f64, width: f64) -> String {
    if text_width(text, weight, size) <= width {
        return text.to_string();
    }
    let mut kept: Vec<char> = text.chars().collect();
    loop {
        // Long texts first lose a twentieth at a time, so that shortening stays cheap.
        let step = (kept.len() / 20).max(1);
        kept.truncate(kept.len() - step.min(kept.len()));
        let candidate = format!("{}…", kept.iter().collect::<String>().trim_end());
        if kept.is_empty() || text_width(&candidate, weight, size) <= width {
            return candidate;
        }
    }
}

/// `text` in lines no wider than `width`, broken at blanks; at most `lines`, the last one shortened.
pub(in crate::plot) fn wrap(
    text: &str,
    weight: Weight,
    size: f64,
    width: f64,
    lines: usize,
) -> Vec<String> {
    let mut done: Vec<String> = Vec::new();
    let mut current = String::new();
    let mut words = text.split_whitespace().peekable();
    while let Some(word) = words.next() {
        let longer = format!("{current} {word}").trim_start().to_owned();
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
    let fit = |line: &String| shorten(line, weight, size, width);
    done.iter().map(fit).collect()
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
