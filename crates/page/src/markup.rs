//! Texts inside of HTML and SVG.

use realgap_core::text::escaped;

/// A foreign text inside of an element or of an attribute in double quotes. Nothing of the text is markup; characters that
/// are invisible or turn the reading direction stand there as escapes.
pub(crate) fn html(text: &str) -> String {
    let mut safe = String::with_capacity(text.len() + 16);
    for c in escaped(text).chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            c => safe.push(c),
        }
    }
    safe
}
