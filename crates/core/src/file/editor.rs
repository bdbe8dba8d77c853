//! Edits of single values of a RON text that leave every other byte as it was.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::outline::{Entry, Outline, opening, outline};
use super::source::{MAX_NESTING, Source};

/// How comments begin that fits write.
const REMARK: &str = "// realgap: ";

/// Edits of a text, which are made all at once at the end.
///
/// ```
/// use realgap_core::file::{RonEditor, Source};
///
/// let text = "(\n    sides: (1, 2), // in metres\n    mass: Some(0.5)\n)";
/// let source = Source::new("box.ron", text);
/// let mut editor = RonEditor::new(&source).unwrap();
/// editor.set("sides[1]", "2.5")?;
/// editor.set("mass", "0.6")?;
/// editor.set("joint.friction", "0.1")?;
/// let changed = "(\n    sides: (1, 2.5), // in metres\n    mass: Some(0.6),\n    joint: (friction: 0.1),\n)";
/// assert_eq!(editor.finish(), changed);
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone)]
pub struct RonEditor<'t> {
    text: &'t str,
    /// The entries by their paths, in which `Some(...)` is no step of its own.
    entries: BTreeMap<String, Entry>,
    outline: Outline,
    /// New values of entries, by the first byte of the value.
    replaced: BTreeMap<usize, (Range<usize>, Node)>,
    /// New entries, by the opening bracket of what they are in; with the whole value.
    added: BTreeMap<usize, (Range<usize>, Fields)>,
    /// Comments, by the first byte of the line before which they stand.
    remarks: BTreeMap<usize, Vec<String>>,
    /// Lines that were changed since the last comment.
    touched: BTreeSet<usize>,
}

/// What an edit has replaced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Replaced {
    /// Line of the value, or of what it was added to, from 1.
    pub line: usize,
    /// Its text before; `None` where the text did not state it.
    pub before: Option<String>,
}

/// New values by their keys.
type Fields = Vec<(String, Node)>;

/// A new value.
#[derive(Debug, Clone)]
enum Node {
    Leaf(String),
    Group(Fields),
}

impl Node {
    /// Puts a value at the end of a path of keys.
    fn put(&mut self, keys: &[&str], value: &str) {
        let Some((key, rest)) = keys.split_first() else {
            *self = Self::Leaf(value.to_owned());
            return;
        };
        if let Self::Leaf(_) = self {
            *self = Self::Group(Vec::new());
        }
        if let Self::Group(fields) = self {
            put(fields, key, rest, value);
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Leaf(text) => text.clone(),
            Self::Group(fields) => format!("({})", fields_text(fields, ", ")),
        }
    }
}

fn put(fields: &mut Fields, key: &str, rest: &[&str], value: &str) {
    let known = fields.iter().position(|(known, _)| known == key);
    let place = known.unwrap_or_else(|| {
        fields.push((key.to_owned(), Node::Group(Vec::new())));
        fields.len() - 1
    });
    fields[place].1.put(rest, value);
}

fn fields_text(fields: &[(String, Node)], between: &str) -> String {
    let each = fields.iter();
    let each = each.map(|(key, node)| format!("{key}: {}", node.text()));
    each.collect::<Vec<_>>().join(between)
}

/// Where new entries of a value stand.
enum Layout {
    /// At the end of a line of entries, at this byte; whether a comma stands before it already.
    Inline { at: usize, has_comma: bool },
    /// Each on a line of its own, before the line that begins at this byte, with this indentation; the byte behind the last entry where
    /// it has no comma.
    Lines {
        at: usize,
        indent: String,
        comma_at: Option<usize>,
    },
}

impl<'t> RonEditor<'t> {
    /// No edit yet. `None` for a text that is not understood to its end, so that a value could be missed.
    pub fn new(source: &'t Source) -> Option<Self> {
        Self::of(source.text())
    }

    fn of(text: &'t str) -> Option<Self> {
        let outline = outline(text, MAX_NESTING).ok()?;
        let wrapped: BTreeSet<&str> = outline
            .entries
            .iter()
            .filter(|entry| is_some(text, &entry.value))
            .map(|entry| entry.path.as_str())
            .collect();
        let mut entries: BTreeMap<String, Entry> = BTreeMap::new();
        // Inner entries come first, so that what is in `Some(...)` stands for the whole.
        for entry in &outline.entries {
            let path = without_some(&entry.path, &wrapped);
            entries.entry(path).or_insert_with(|| entry.clone());
        }
        Some(Self {
            text,
            entries,
            outline,
            replaced: BTreeMap::new(),
            added: BTreeMap::new(),
            remarks: BTreeMap::new(),
            touched: BTreeSet::new(),
        })
    }

    /// Whether the text states a value at a path.
    pub fn has(&self, path: &str) -> bool {
        self.entries.contains_key(path)
    }

    /// The text of a value as it was.
    pub fn text_at(&self, path: &str) -> Option<&'t str> {
        let entry = self.entries.get(path)?;
        Some(&self.text[entry.value.clone()])
    }

    /// The text of a value with edits of it, for another place; `None` for one that the text does not state.
    ///
    /// # Errors
    /// As [`RonEditor::set`].
    pub fn copy_with(
        &self,
        path: &str,
        edits: &[(String, String)],
    ) -> Option<Result<String, String>> {
        let mut own = Self::of(self.text_at(path)?)?;
        let each = edits
            .iter()
            .try_for_each(|(path, value)| own.set(path, value).map(|_| ()));
        Some(each.map(|()| own.finish()))
    }

    /// Sets the value at a path. Where the text does not state it, it is added, with all that it is in.
    ///
    /// # Errors
    /// A path through an element of a list that does not exist.
    pub fn set(&mut self, path: &str, value: &str) -> Result<Replaced, String> {
        if let Some(entry) = self.entries.get(path).cloned() {
            let line = self.touch(self.line_start(entry.value.start));
            let before = self.text[entry.value.clone()].to_owned();
            let node = Node::Leaf(value.to_owned());
            self.replaced.insert(entry.value.start, (entry.value, node));
            return Ok(Replaced {
                line,
                before: Some(before),
            });
        }
        let (mut inner, mut keys) = (path, Vec::new());
        let whole = loop {
            if inner.ends_with(']') {
                return Err(format!("the file has no `{path}`"));
            }
            let (outer, key) = inner.rsplit_once('.').unwrap_or(("", inner));
            keys.insert(0, key);
            match self.entries.get(outer) {
                _ if outer.is_empty() => break self.outline.root.clone(),
                Some(entry) => break entry.value.clone(),
                None => inner = outer,
            }
        };
        let (key, rest) = (keys[0], &keys[1..]);
        let line = match opening(self.text, &whole) {
            Some(open) => {
                let at = match self.layout(&whole, open) {
                    Layout::Inline { at, .. } => self.line_start(at),
                    Layout::Lines { at, .. } => at,
                };
                let (_, fields) = self.added.entry(open).or_insert((whole, Vec::new()));
                put(fields, key, rest, value);
                self.touch(at)
            }
            // A value without brackets, such as `None`.
            None => {
                let at = self.line_start(whole.start);
                let known = self.replaced.entry(whole.start);
                let (_, node) = known.or_insert((whole, Node::Group(Vec::new())));
                node.put(&keys, value);
                self.touch(at)
            }
        };
        Ok(Replaced { line, before: None })
    }

    /// Puts a comment before each line that was changed since the last comment.
    pub fn remark(&mut self, text: &str) {
        let plain = text.replace(['\n', '\r'], " ").trim().to_owned();
        for at in std::mem::take(&mut self.touched) {
            let remarks = self.remarks.entry(at).or_default();
            if !plain.is_empty() && !remarks.contains(&plain) {
                remarks.push(plain.clone());
            }
        }
    }

    /// The text with all edits.
    pub fn finish(&self) -> String {
        let mut patches: Vec<(Range<usize>, String)> = Vec::new();
        for (at, remarks) in &self.remarks {
            patches.push(self.comment(*at, remarks));
        }
        for (range, node) in self.replaced.values() {
            patches.push((range.clone(), node.text()));
        }
        for (open, (whole, fields)) in &self.added {
            self.patch_added(whole, *open, fields, &mut patches);
        }
        // The order of patches at one place is that in which they were made: comments first.
        patches.sort_by_key(|(range, _)| range.start);
        let (mut text, mut at) = (String::with_capacity(self.text.len()), 0);
        for (range, with) in patches {
            text.push_str(&self.text[at..range.start]);
            text.push_str(&with);
            at = range.end;
        }
        text + &self.text[at..]
    }

    /// Remembers a changed line by its first byte, and gives its number.
    fn touch(&mut self, at: usize) -> usize {
        self.touched.insert(at);
        1 + self.text[..at].matches('\n').count()
    }

    /// The end of the last entry in brackets; `None` if they are empty.
    fn last_end(&self, inside: &Range<usize>) -> Option<usize> {
        let all = self.outline.entries.iter();
        let inner =
            all.filter(|entry| inside.start <= entry.whole.start && entry.whole.end <= inside.end);
        inner.map(|entry| entry.whole.end).max()
    }

    fn layout(&self, whole: &Range<usize>, open: usize) -> Layout {
        let close = whole.end - 1;
        let Some(last) = self.last_end(&(open + 1..close)) else {
            return Layout::Inline {
                at: close,
                has_comma: true,
            };
        };
        let comma = self.comma(last, close);
        let start = self.text[..close].rfind('\n').map_or(0, |end| end + 1);
        let is_own_line =
            start > last && !self.is_opaque(start) && self.text[start..close].trim().is_empty();
        if is_own_line {
            let first = self.line_start(last);
            return Layout::Lines {
                at: start,
                indent: self.indent(first).to_owned(),
                comma_at: comma.is_none().then_some(last),
            };
        }
        match comma {
            Some(comma) => Layout::Inline {
                at: comma + 1,
                has_comma: true,
            },
            None => Layout::Inline {
                at: last,
                has_comma: false,
            },
        }
    }

    /// The byte of the comma behind the last entry.
    fn comma(&self, last: usize, close: usize) -> Option<usize> {
        let mut at = last;
        loop {
            let rest = &self.text[at..close];
            at += rest.len() - rest.trim_start().len();
            let rest = &self.text[at..close];
            if rest.starts_with("//") {
                at += rest.find('\n')?;
            } else if let Some(comment) = self.opaque_at(at).filter(|_| rest.starts_with("/*")) {
                at = comment.end;
            } else {
                return rest.starts_with(',').then_some(at);
            }
        }
    }

    fn patch_added(
        &self,
        whole: &Range<usize>,
        open: usize,
        fields: &[(String, Node)],
        patches: &mut Vec<(Range<usize>, String)>,
    ) {
        match self.layout(whole, open) {
            Layout::Inline { at, has_comma } => {
                let is_empty = at == whole.end - 1 && self.last_end(&(open + 1..at)).is_none();
                let list = fields_text(fields, ", ");
                let text = match (is_empty, has_comma) {
                    (true, _) => list,
                    (false, true) => format!(" {list},"),
                    (false, false) => format!(", {list}"),
                };
                patches.push((at..at, text));
            }
            Layout::Lines {
                at,
                indent,
                comma_at,
            } => {
                if let Some(comma_at) = comma_at {
                    patches.push((comma_at..comma_at, ",".to_owned()));
                }
                let end = self.line_end();
                let each = fields
                    .iter()
                    .map(|(key, node)| format!("{indent}{key}: {},{end}", node.text()));
                patches.push((at..at, each.collect()));
            }
        }
    }

    /// The comments before the line that begins at a byte; they replace those of earlier fits about the same parameters.
    fn comment(&self, at: usize, remarks: &[String]) -> (Range<usize>, String) {
        let end = self.line_end();
        // A line for a closing bracket stands one level further out than the entries before it.
        let is_closing = self.text[at..].trim_start().starts_with([')', ']', '}']);
        let above = self.text[..at].trim_end().len();
        let indent = match is_closing && above > 0 {
            true => self.indent(self.line_start(above - 1)),
            false => self.indent(at),
        };
        let name = |remark: &str| remark.split_once(" = ").map(|(name, _)| name.to_owned());
        let new: Vec<Option<String>> = remarks.iter().map(|remark| name(remark)).collect();
        let (mut start, mut kept) = (at, Vec::new());
        while start > 0 {
            let above = self.text[..start - 1].rfind('\n').map_or(0, |end| end + 1);
            let line = &self.text[above..start];
            if self.is_opaque(above) || !line.trim_start().starts_with(REMARK) {
                break;
            }
            let own = line.trim_start().trim_start_matches("// ");
            if !new.contains(&name(own)) {
                kept.insert(0, line.to_owned());
            }
            start = above;
        }
        let new = remarks
            .iter()
            .map(|remark| format!("{indent}// {remark}{end}"));
        (start..at, kept.into_iter().chain(new).collect())
    }

    /// The first byte of the line of a byte; of an earlier line where that one begins in a string or a block comment.
    fn line_start(&self, at: usize) -> usize {
        let mut start = self.text[..at].rfind('\n').map_or(0, |end| end + 1);
        while let Some(around) = self.opaque_around(start) {
            start = self.text[..around.start]
                .rfind('\n')
                .map_or(0, |end| end + 1);
        }
        start
    }

    fn indent(&self, at: usize) -> &'t str {
        let line = self.text[at..].lines().next().unwrap_or_default();
        &line[..line.len() - line.trim_start().len()]
    }

    fn line_end(&self) -> &'static str {
        let first = self.text.find('\n');
        match first.is_some_and(|end| self.text[..end].ends_with('\r')) {
            true => "\r\n",
            false => "\n",
        }
    }

    fn opaque_at(&self, at: usize) -> Option<&Range<usize>> {
        self.outline.opaque.iter().find(|range| range.start == at)
    }

    /// The string or block comment that a byte is inside of.
    fn opaque_around(&self, at: usize) -> Option<&Range<usize>> {
        let mut all = self.outline.opaque.iter();
        all.find(|range| range.start < at && at < range.end)
    }

    fn is_opaque(&self, at: usize) -> bool {
        self.opaque_around(at).is_some()
    }
}

/// Whether a value is `Some(...)`.
fn is_some(text: &str, value: &Range<usize>) -> bool {
    let is_word = text[value.clone()].strip_prefix("Some");
    is_word.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        && opening(text, value).is_some()
}

/// A path without the steps into `Some(...)`.
fn without_some(path: &str, wrapped: &BTreeSet<&str>) -> String {
    let (mut plain, mut at) = (String::new(), 0);
    while let Some(step) = path[at..].find("[0]") {
        let before = at + step;
        plain.push_str(&path[at..before]);
        if !wrapped.contains(&path[..before]) {
            plain.push_str("[0]");
        }
        at = before + "[0]".len();
    }
    plain + &path[at..]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(text: &str, edits: &[(&str, &str)]) -> String {
        let mut editor = RonEditor::of(text).unwrap();
        for (path, value) in edits {
            editor.set(path, value).unwrap();
            editor.remark(&format!("realgap: {path} = {value}"));
        }
        editor.finish()
    }

    #[test]
    fn values_are_added_where_people_would_write_them() {
        for (text, path, expected) in [
            ("(a: 1)", "b", "(a: 1, b: 2)"),
            ("(a: 1,)", "b", "(a: 1, b: 2,)"),
            ("(a: 1 /* one */ , )", "b", "(a: 1 /* one */ , b: 2, )"),
            ("(a: X())", "a.b", "(a: X(b: 2))"),
            ("(a: None)", "a.b.c", "(a: (b: (c: 2)))"),
            ("(a: Some((c: 1)))", "a.b", "(a: Some((c: 1, b: 2)))"),
            ("(a: Some(1))", "a", "(a: Some(2))"),
            ("()", "a", "(a: 2)"),
        ] {
            let mut editor = RonEditor::of(text).unwrap();
            editor.set(path, "2").unwrap();
            assert_eq!(editor.finish(), expected);
        }
    }

    #[test]
    fn lines_stay_lines_and_comments_stay_with_their_values() {
        let text = "(\n  a: 1, // first\n  c: (\n    d: r#\"\n\"(\"\n\"#\n    // last\n  ),\n)\n";
        let expected = "(\n  // realgap: a = 5\n  a: 5, // first\n  c: (\n    d: r#\"\n\"(\"\n\"#,\n    // last\n    // realgap: c.e = 6\n    e: 6,\n  ),\n)\n";
        assert_eq!(changed(text, &[("a", "5"), ("c.e", "6")]), expected);
    }

    #[test]
    fn a_comment_is_never_put_into_a_string_and_replaces_its_predecessor() {
        let text = "(name: \"two\nlines\", a: 1)";
        let once = changed(text, &[("a", "3")]);
        assert_eq!(once, "// realgap: a = 3\n(name: \"two\nlines\", a: 3)");
        let twice = changed(&once, &[("a", "4")]);
        assert_eq!(twice, "// realgap: a = 4\n(name: \"two\nlines\", a: 4)");
        let other = changed(&once, &[("b", "4")]);
        assert!(
            other.starts_with("// realgap: a = 3\n// realgap: b = 4\n("),
            "{other}"
        );
    }
}
