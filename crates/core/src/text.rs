//! Makes texts from untrusted files safe to show: on a terminal, in one line of an error, in a cell of a table.
//!
//! Names, keys, paths and column values come from files of unknown origin. Such a text must not move the cursor,
//! change a terminal's title, reverse the reading direction or look like another line of a message.

use std::borrow::Cow;

/// True for a character that only prints its own glyph: no control character, no invisible character, none that changes the reading
/// direction.
pub fn is_plain(c: char) -> bool {
    !c.is_control()
        && !matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// The text with every character that is not plain ([`is_plain`]) written as an escape, e.g. `\u{1b}`.
///
/// ```
/// use realgap_core::text::escaped;
///
/// assert_eq!(escaped("größe 3 %"), "größe 3 %");
/// assert_eq!(escaped("\u{1b}[2J\n"), "\\u{1b}[2J\\n");
/// ```
pub fn escaped(text: &str) -> Cow<'_, str> {
    escaped_but(text, |_| false)
}

/// As [`escaped`] for a text of several lines: line feeds and tabs stay.
pub fn escaped_lines(text: &str) -> Cow<'_, str> {
    escaped_but(text, |c| matches!(c, '\n' | '\t'))
}

fn escaped_but(text: &str, stays: impl Fn(char) -> bool) -> Cow<'_, str> {
    if text.chars().all(|c| is_plain(c) || stays(c)) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(2 * text.len());
    for c in text.chars() {
        if is_plain(c) || stays(c) {
            safe.push(c);
        } else {
            safe.extend(c.escape_default());
        }
    }
    Cow::Owned(safe)
}

/// JSON text in which every character that is not plain ([`is_plain`]) is written as a JSON escape: the value is the same, because such
/// characters occur inside strings only.
///
/// ```
/// use realgap_core::text::escaped_json;
///
/// assert_eq!(escaped_json("{\n\"a\": \"\u{202e}b\"\n}".to_owned()), "{\n\"a\": \"\\u202eb\"\n}");
/// ```
pub fn escaped_json(json: String) -> String {
    let stays = |c: char| is_plain(c) || c == '\n';
    if json.chars().all(stays) {
        return json;
    }
    let mut safe = String::with_capacity(json.len());
    for c in json.chars() {
        if stays(c) {
            safe.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                safe += &format!("\\u{unit:04x}");
            }
        }
    }
    safe
}

/// As [`escaped`], with at most `longest` characters of the text; a longer text is cut to its start, followed by ` ...`.
///
/// ```
/// use realgap_core::text::shown;
///
/// assert_eq!(shown("abc", 3), "abc");
/// assert_eq!(shown("abcdef", 3), "abc ...");
/// ```
pub fn shown(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        None => escaped(text).into_owned(),
        Some((end, _)) => format!("{} ...", escaped(&text[..end])),
    }
}

/// As [`shown`], but a longer text is cut to its end, because the end of a path is the most informative part.
pub fn shown_end(text: &str, longest: usize) -> String {
    let count = text.chars().count();
    match text.char_indices().nth(count.saturating_sub(longest)) {
        Some((start, _)) if start > 0 => format!("... {}", escaped(&text[start..])),
        _ => escaped(text).into_owned(),
    }
}

/// A CSV cell that a spreadsheet reads as text: a `'` is put before a text that it would run as a formula (`=1+1`, `@SUM(A1)`). Numbers
/// stay unchanged.
///
/// ```
/// use realgap_core::text::cell;
///
/// assert_eq!(cell("=1+1"), "'=1+1");
/// assert_eq!(cell("-1.5e-3"), "-1.5e-3");
/// assert_eq!(cell("run_00"), "run_00");
/// ```
pub fn cell(text: &str) -> Cow<'_, str> {
    let computes = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    if computes && text.parse::<f64>().is_err() {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Whether a name has a form in which `*` stands for any letters, also none.
pub fn fits(form: &str, name: &str) -> bool {
    let mut parts = form.split('*');
    let Some(mut rest) = name.strip_prefix(parts.next().unwrap_or_default()) else {
        return false;
    };
    let Some(last) = parts.next_back() else {
        return rest.is_empty();
    };
    for part in parts {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_control_a_terminal_are_escaped() {
        for (steers, seen) in [
            ("\u{1b}]0;title\u{7}", "\\u{1b}]0;title\\u{7}"),
            ("\u{9b}31m", "\\u{9b}31m"),
            ("a\rb\u{8}", "a\\rb\\u{8}"),
            ("\u{202e}gnp.exe", "\\u{202e}gnp.exe"),
            ("zero\u{200b}width", "zero\\u{200b}width"),
        ] {
            assert_eq!(escaped(steers), seen);
            assert_eq!(shown(steers, 100), seen);
            assert!(escaped(steers).chars().all(is_plain));
        }
        assert_eq!(escaped_lines("a\tb\nc\r"), "a\tb\nc\\r");
    }

    #[test]
    fn long_texts_are_cut_to_their_start_and_long_paths_to_their_end() {
        let long = "ä".repeat(500);
        assert_eq!(shown(&long, 20).chars().count(), 24);
        assert_eq!(shown_end("/a/b/c.ron", 5), "... c.ron");
        assert_eq!(shown_end("c.ron", 5), "c.ron");
        assert_eq!(shown_end("", 5), "");
    }

    #[test]
    fn formulas_of_a_spreadsheet_become_text_and_numbers_stay_numbers() {
        for text in ["=1", "+A1", "-A1", "@SUM(A1)", "\t=1", "--1", "-"] {
            assert_eq!(cell(text), format!("'{text}"));
        }
        for number in ["-1", "+1.5", "-0.000001", "-1e300", "-inf", "NaN", "1", ""] {
            assert_eq!(cell(number), number);
        }
    }

    #[test]
    fn a_star_stands_for_any_letters() {
        for (form, name, is) in [
            ("", "", true),
            ("elbow", "elbow", true),
            ("elbow", "elbow_flex", false),
            ("shoulder_*", "shoulder_pan", true),
            ("*_flex", "wrist_flex", true),
            ("*_flex", "wrist_roll", false),
            ("a*b*c", "axxbyyc", true),
            ("a*b*c", "axxc", false),
            ("*", "anything", true),
            ("ab*ba", "aba", false),
        ] {
            assert_eq!(fits(form, name), is, "{form} {name}");
        }
    }
}
