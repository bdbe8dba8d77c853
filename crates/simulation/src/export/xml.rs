//! A minimal XML writer for robot files: elements, attributes and comments, escaped and indented.

use std::fmt::Write as _;

use nalgebra::Vector3;

/// An element with attributes and children, in the order in which they were added.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Node>,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Element(Element),
    Comment(String),
}

impl Element {
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            attributes: Vec::new(),
            children: Vec::new(),
        }
    }

    #[must_use]
    pub fn with(mut self, attribute: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((attribute, value.into()));
        self
    }

    #[must_use]
    pub fn child(mut self, child: Self) -> Self {
        self.push(child);
        self
    }

    pub fn push(&mut self, child: Self) {
        self.children.push(Node::Element(child));
    }

    pub fn comment(&mut self, text: impl Into<String>) {
        self.children.push(Node::Comment(text.into()));
    }

    /// The whole document: the comments, followed by this root element.
    pub fn document(&self, comments: &[String]) -> String {
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        for comment in comments {
            write_comment(&mut text, comment, 0);
        }
        self.write(&mut text, 0);
        text
    }

    fn write(&self, text: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        // Writing to a String cannot fail.
        let _ = write!(text, "{indent}<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escape(value));
        }
        if self.children.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        for child in &self.children {
            match child {
                Node::Element(element) => element.write(text, depth + 1),
                Node::Comment(comment) => write_comment(text, comment, depth + 1),
            }
        }
        let _ = writeln!(text, "{indent}</{}>", self.name);
    }
}

fn write_comment(text: &mut String, comment: &str, depth: usize) {
    // An XML comment must not contain "--" or end with "-".
    let mut safe = allowed(comment);
    while safe.contains("--") {
        safe = safe.replace("--", "- -");
    }
    let _ = writeln!(text, "{}<!-- {safe} -->", "  ".repeat(depth));
}

/// Replaces control characters that XML 1.0 cannot represent.
fn allowed(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\t' | '\n' | '\r' => c,
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
            _ => c,
        })
        .collect()
}

fn escape(value: &str) -> String {
    let mut escaped = String::with_capacity(value.len());
    for c in allowed(value).chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' | '\n' | '\r' => {
                let _ = write!(escaped, "&#{};", u32::from(c));
            }
            _ => escaped.push(c),
        }
    }
    escaped
}

/// Numbers separated by spaces, in a form that is read back bit for bit; values of rounding errors are written as 0.
pub(super) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    const ROUNDING: f64 = 1e-15;
    let words: Vec<String> = values
        .into_iter()
        .map(|value| match value.abs() {
            size if size < ROUNDING => "0".to_owned(),
            size if size < 1e-5 => format!("{value:e}"),
            _ => value.to_string(),
        })
        .collect();
    words.join(" ")
}

/// The three numbers of a vector.
pub(super) fn vector(v: &Vector3<f64>) -> String {
    numbers(v.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped_in_attributes_and_comments() {
        let value = "a<b>&\"c\"\n--\u{1}'";
        let mut root = Element::new("r").with("a", value);
        root.comment("x --- y-");
        let text = root.document(&["-->".to_owned()]);
        assert!(text.contains("a=\"a&lt;b&gt;&amp;&quot;c&quot;&#10;--\u{fffd}'\""));
        for comment in text.split("<!--").skip(1) {
            let (inside, _) = comment.split_once("-->").unwrap();
            assert!(!inside.contains("--"), "{inside}");
            assert!(inside.ends_with(' '));
        }
    }

    #[test]
    fn numbers_are_exact_and_rounding_errors_become_zero() {
        assert_eq!(
            numbers([0.1, -0.0, 1e-17, 8.7e-6, -2.0]),
            "0.1 0 0 8.7e-6 -2"
        );
    }
}
