//! Measures an XML text in one pass without recursion, before a parser of another project gets it: its elements, their depth and their
//! attributes.
//!
//! The scanner needs no well-formed text: what it does not understand is left to the parser, which refuses it.

use crate::error::{Error, Result};

/// The largest sizes of an XML text that a parser gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct XmlLimits {
    /// Elements that are open at once.
    pub depth: usize,
    /// Elements in all.
    pub elements: usize,
    /// Attributes of one element.
    pub attributes: usize,
}

/// The sizes of an XML text.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct XmlSize {
    /// The largest number of elements that are open at once.
    pub depth: usize,
    /// Number of elements.
    pub elements: usize,
    /// The largest number of attributes of one element.
    pub attributes: usize,
}

/// Declarations of namespaces that a text may have: a parser compares each of them with the names of every element.
const MOST_NAMESPACES: usize = 1000;

/// The sizes of an XML text.
///
/// # Errors
/// A text that exceeds a limit; the error names line and column of the element where it does.
pub fn measure_xml(text: &str, limits: XmlLimits) -> Result<XmlSize> {
    let mut size = XmlSize::default();
    let (mut open, mut namespaces, mut at) = (0_usize, 0_usize, 0_usize);
    while let Some(start) = find(text, at, "<") {
        let rest = &text[start..];
        let skipped = [
            ("<!--", "-->"),
            ("<![CDATA[", "]]>"),
            ("<?", "?>"),
            ("<!", ">"),
        ];
        if let Some((begin, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            // A part that never ends is what the parser complains about.
            let Some(stop) = find(text, start + begin.len(), end) else {
                break;
            };
            at = stop + end.len();
            continue;
        }
        let tag = Tag::scan(rest);
        at = start + tag.length;
        if rest.starts_with("</") {
            open = open.saturating_sub(1);
            continue;
        }
        namespaces += tag.namespaces;
        size.elements += 1;
        size.depth = size.depth.max(open + 1);
        size.attributes = size.attributes.max(tag.attributes);
        if !tag.is_closed {
            open += 1;
        }
        let checks = [
            (size.depth, limits.depth, "elements nested in each other"),
            (size.elements, limits.elements, "elements"),
            (
                size.attributes,
                limits.attributes,
                "attributes of one element",
            ),
            (namespaces, MOST_NAMESPACES, "declarations of namespaces"),
        ];
        if let Some((found, most, what)) = checks.iter().find(|(found, most, _)| found > most) {
            let before = &text[..start];
            let line = 1 + before.matches('\n').count();
            let column = 1 + before[before.rfind('\n').map_or(0, |at| at + 1)..]
                .chars()
                .count();
            return Err(Error::invalid("the XML is larger than what is read")
                .at_line(line, column)
                .found(format!("{found} {what}, and perhaps more"))
                .allowed(format!("at most {most} {what}"))
                .hint("is the file broken, or made by a faulty program?"));
        }
    }
    Ok(size)
}

fn find(text: &str, from: usize, what: &str) -> Option<usize> {
    Some(from + text.get(from..)?.find(what)?)
}

/// What the scanner finds of one tag.
struct Tag {
    /// Bytes from `<` to `>`, both included.
    length: usize,
    attributes: usize,
    namespaces: usize,
    /// Whether the tag ends with `/>`.
    is_closed: bool,
}

impl Tag {
    /// Scans a text that begins with a tag.
    fn scan(text: &str) -> Self {
        let bytes = text.as_bytes();
        let mut tag = Self {
            length: bytes.len(),
            attributes: 0,
            namespaces: 0,
            is_closed: false,
        };
        let (mut at, mut name) = (1, 1);
        while at < bytes.len() {
            match bytes[at] {
                b'>' => {
                    tag.is_closed = bytes[at - 1] == b'/';
                    tag.length = at + 1;
                    break;
                }
                b' ' | b'\t' | b'\r' | b'\n' => name = at + 1,
                b'=' => {
                    tag.attributes += 1;
                    tag.namespaces += usize::from(text[name.min(at)..at].starts_with("xmlns"));
                }
                quote @ (b'"' | b'\'') => {
                    // An attribute that never ends is what the parser complains about.
                    let end = bytes[at + 1..].iter().position(|byte| *byte == quote);
                    at += end.map_or(bytes.len(), |end| end + 1);
                }
                _ => {}
            }
            at += 1;
        }
        tag
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: XmlLimits = XmlLimits {
        depth: 4,
        elements: 8,
        attributes: 3,
    };

    #[test]
    fn elements_depth_and_attributes_are_counted() {
        let text = "<?xml version='1.0'?><!-- <x><y> --><a b='>' c=\"</a>\"><d/><![CDATA[<e><f>]]><g h='1'></g ></a>";
        let size = measure_xml(text, LIMITS).unwrap();
        assert_eq!(
            size,
            XmlSize {
                depth: 2,
                elements: 3,
                attributes: 2
            }
        );
    }

    #[test]
    fn what_exceeds_a_limit_is_refused_with_its_line() {
        let refused = |text: &str| measure_xml(text, LIMITS).unwrap_err().to_string();
        let error = refused("<a>\n<a><a>\n <a><a>");
        assert!(error.contains("nested") && error.contains("3:5"), "{error}");
        assert!(refused(&"<a/>".repeat(9)).contains("at most 8 elements"));
        assert!(refused("<a b='' c='' d='' e=''/>").contains("at most 3 attributes"));
        let many = |count| format!("<a>{}</a>", "<b xmlns:c='d'/>".repeat(count));
        let wide = XmlLimits {
            elements: 10_000,
            ..LIMITS
        };
        assert!(measure_xml(&many(MOST_NAMESPACES), wide).is_ok());
        let error = measure_xml(&many(MOST_NAMESPACES + 1), wide).unwrap_err();
        assert!(error.to_string().contains("namespaces"), "{error}");
    }

    #[test]
    fn broken_texts_end_and_are_left_to_the_parser() {
        for text in [
            "",
            "<",
            "<a",
            "<a b='",
            "<!--",
            "<![CDATA[",
            "</a></a>",
            "a>b",
            "<é ü='ß'>",
            "<a =",
        ] {
            assert!(measure_xml(text, LIMITS).is_ok(), "{text}");
        }
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_measured(text in "[<>a/ ='\"!?é\\[\\]CDAT-]{0,60}") {
            if let Ok(size) = measure_xml(&text, LIMITS) {
                proptest::prop_assert!(size.elements <= text.matches('<').count());
            }
        }
    }
}
