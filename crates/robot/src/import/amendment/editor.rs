//! Edits of the text of an XML file that leave every other byte as it was.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::super::element::words;
use super::Written;

/// How comments begin that fits write.
const REMARK: &str = "<!-- realgap: ";

/// Edits of a text, which are made all at once at the end.
#[derive(Debug, Clone)]
pub(in crate::import) struct Editor<'t, 'd> {
    text: &'t str,
    document: &'d Document<'d>,
    /// New texts of attributes, by the first byte of their element and their name; `None` for one that is taken out.
    attributes: BTreeMap<(usize, String), Option<String>>,
    /// New child elements, by the first byte of their parent, with the tag of each.
    children: BTreeMap<(usize, String), BTreeMap<String, String>>,
    /// Comments before elements, by the first byte of the element.
    remarks: BTreeMap<usize, Vec<String>>,
    /// The elements that were changed since the last comment.
    touched: Vec<usize>,
}

impl<'t, 'd> Editor<'t, 'd> {
    /// No edit yet of a text, of which `document` has the same bytes but for comments.
    pub fn new(text: &'t str, document: &'d Document<'d>) -> Self {
        Self {
            text,
            document,
            attributes: BTreeMap::new(),
            children: BTreeMap::new(),
            remarks: BTreeMap::new(),
            touched: Vec::new(),
        }
    }

    /// The document as it was.
    pub fn document(&self) -> &'d Document<'d> {
        self.document
    }

    /// The element that begins at a byte.
    pub fn element(&self, at: usize) -> Option<Node<'d, 'd>> {
        let mut all = self.document.root().descendants();
        all.find(|node| node.is_element() && node.range().start == at)
    }

    fn touch(&mut self, node: Node<'d, 'd>) {
        let at = node.range().start;
        if !self.touched.contains(&at) {
            self.touched.push(at);
        }
    }

    /// The text of an attribute with the edits so far.
    fn current(&self, node: Node<'d, 'd>, attribute: &str) -> Option<String> {
        match self
            .attributes
            .get(&(node.range().start, attribute.to_owned()))
        {
            Some(text) => text.clone(),
            None => node.attribute(attribute).map(str::to_owned),
        }
    }

    /// Sets the text of an attribute.
    pub fn set(&mut self, node: Node<'d, 'd>, attribute: &str, now: String) -> Written {
        self.touch(node);
        let before = node.attribute(attribute).map(str::to_owned);
        let key = (node.range().start, attribute.to_owned());
        self.attributes.insert(key, Some(now.clone()));
        Written {
            line: self.line(node),
            element: label(node),
            attribute: attribute.to_owned(),
            before,
            now,
        }
    }

    /// Sets one of the numbers of an attribute, and leaves the others as they are written. Numbers that the element does not state
    /// are those of `usual`.
    pub fn set_number(
        &mut self,
        node: Node<'d, 'd>,
        attribute: &str,
        (index, value): (usize, f64),
        usual: &[String],
    ) -> Written {
        let stated = self.current(node, attribute).unwrap_or_default();
        let count = words(&stated).count();
        let now = match words(&stated).nth(index) {
            Some(word) => {
                let at = word.as_ptr() as usize - stated.as_ptr() as usize;
                format!("{}{value}{}", &stated[..at], &stated[at + word.len()..])
            }
            None => {
                let between = (count..index).map(|k| usual.get(k).map_or("0", String::as_str));
                let known = words(&stated).chain(between).map(str::to_owned);
                let all: Vec<String> = known.chain([value.to_string()]).collect();
                all.join(" ")
            }
        };
        self.set(node, attribute, now)
    }

    /// Takes an attribute out.
    pub fn remove(&mut self, node: Node<'d, 'd>, attribute: &str) {
        self.touch(node);
        let key = (node.range().start, attribute.to_owned());
        self.attributes.insert(key, None);
    }

    /// Sets an attribute of a child that the element does not have yet.
    pub fn set_of_new_child(
        &mut self,
        parent: Node<'d, 'd>,
        tag: &str,
        attribute: &str,
        now: String,
    ) -> Written {
        self.touch(parent);
        let key = (parent.range().start, tag.to_owned());
        let child = self.children.entry(key).or_default();
        child.insert(attribute.to_owned(), now.clone());
        Written {
            line: self.line(parent),
            element: format!("{tag} of {}", label(parent)),
            attribute: attribute.to_owned(),
            before: None,
            now,
        }
    }

    /// Puts a comment before each element that was changed since the last comment.
    pub fn remark(&mut self, text: &str) {
        // A comment of XML may contain no two hyphens, and end with none.
        let mut plain = text.replace(['\n', '\r'], " ");
        while plain.contains("--") {
            plain = plain.replace("--", "- -");
        }
        let plain = plain.trim_end_matches('-').trim().to_owned();
        for at in std::mem::take(&mut self.touched) {
            let remarks = self.remarks.entry(at).or_default();
            if !plain.is_empty() && !remarks.contains(&plain) {
                remarks.push(plain.clone());
            }
        }
    }

    /// The line of an element, from 1.
    fn line(&self, node: Node<'d, 'd>) -> usize {
        1 + self.text[..node.range().start].matches('\n').count()
    }

    /// The text with all edits.
    pub fn finish(&self) -> String {
        let mut patches: Vec<(usize, usize, String)> = Vec::new();
        for node in self.document.root().descendants().filter(Node::is_element) {
            let at = node.range().start;
            if let Some(remarks) = self.remarks.get(&at) {
                patches.push((self.earlier_remarks(at), at, self.comment(at, remarks)));
            }
            self.patch_attributes(node, &mut patches);
            self.patch_children(node, &mut patches);
        }
        // The order of patches at one place is that in which they were found.
        patches.sort_by_key(|(start, ..)| *start);
        let (mut text, mut at) = (String::with_capacity(self.text.len()), 0);
        for (start, end, with) in patches {
            text.push_str(&self.text[at..start]);
            text.push_str(&with);
            at = end;
        }
        text + &self.text[at..]
    }

    fn patch_attributes(&self, node: Node<'d, 'd>, patches: &mut Vec<(usize, usize, String)>) {
        let at = node.range().start;
        let last = node.attributes().map(|own| own.range().end).max();
        let first = (at, String::new());
        let own = self.attributes.range(first..(at + 1, String::new()));
        for ((_, name), value) in own {
            let known = node.attribute_node(name.as_str());
            patches.push(match (known, value) {
                (Some(known), Some(value)) => {
                    let range = known.range_value();
                    (range.start, range.end, value.clone())
                }
                (Some(known), None) => {
                    let range = known.range();
                    let before = self.text[..range.start].trim_end().len();
                    (before, range.end, String::new())
                }
                (None, Some(value)) => {
                    let place = last.unwrap_or_else(|| at + 1 + self.name_length(at));
                    (place, place, format!(" {name}=\"{value}\""))
                }
                (None, None) => continue,
            });
        }
    }

    fn patch_children(&self, node: Node<'d, 'd>, patches: &mut Vec<(usize, usize, String)>) {
        let range = node.range();
        let first = (range.start, String::new());
        let own = self.children.range(first..(range.start + 1, String::new()));
        for ((_, tag), attributes) in own {
            let each = attributes.iter();
            let each = each.map(|(name, value)| format!(" {name}=\"{value}\""));
            let child = format!("<{tag}{}/>", each.collect::<String>());
            let last = node.children().rfind(Node::is_element);
            patches.push(match (last, self.text[range.clone()].rfind("</")) {
                (Some(last), _) => {
                    let end = last.range().end;
                    let break_line = self.break_before(last.range().start);
                    (end, end, format!("{break_line}{child}"))
                }
                (None, Some(close)) => {
                    let place = range.start + close;
                    (place, place, child)
                }
                // An element that is closed at once.
                (None, None) => {
                    let slash = range.end - 2;
                    let before = self.text[..slash].trim_end().len();
                    let own = &self.text[range.start + 1..][..self.name_length(range.start)];
                    (before, range.end, format!(">{child}</{own}>"))
                }
            });
        }
    }

    /// Bytes of the name of the element that begins at a byte.
    fn name_length(&self, at: usize) -> usize {
        let name = &self.text[at + 1..];
        let is_end = |c: char| c.is_whitespace() || c == '/' || c == '>';
        name.find(is_end).unwrap_or(name.len())
    }

    fn comment(&self, at: usize, remarks: &[String]) -> String {
        let each = remarks.iter().map(|remark| format!("<!-- {remark} -->"));
        let after = match self.break_before(at) {
            none if none.is_empty() => " ".to_owned(),
            line => line,
        };
        each.map(|comment| format!("{comment}{after}")).collect()
    }

    /// The first byte of the comments that an earlier fit has put right before an element, which the new ones replace.
    fn earlier_remarks(&self, at: usize) -> usize {
        let mut start = at;
        loop {
            let before = self.text[..start].trim_end();
            let Some(open) = before.rfind("<!--").filter(|_| before.ends_with("-->")) else {
                return start;
            };
            if !before[open..].starts_with(REMARK) {
                return start;
            }
            start = open;
        }
    }

    /// The end of a line and the blanks before an element; empty for one that is not the first of its line.
    fn break_before(&self, at: usize) -> String {
        let before = &self.text[..at];
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let indent = &before[start..];
        if !indent.trim().is_empty() || start == 0 {
            return String::new();
        }
        let end = if before[..start].ends_with("\r\n") {
            "\r\n"
        } else {
            "\n"
        };
        format!("{end}{indent}")
    }
}

/// Tag and name of an element.
fn label(node: Node<'_, '_>) -> String {
    let tag = node.tag_name().name();
    let mut named = node.ancestors();
    let name = named.find_map(|above| above.attribute("name"));
    match (node.attribute("name"), name) {
        (Some(own), _) => format!("{tag} {own}"),
        (None, Some(above)) => format!("{tag} of {above}"),
        (None, None) => tag.to_owned(),
    }
}
