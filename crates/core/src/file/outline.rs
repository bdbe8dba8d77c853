//! Finds the position of a field in a RON text: a simple scanner for brackets, strings and comments, without types.
//!
//! The RON parser gives positions only while it parses, but errors that are found later, when values are
//! checked against each other, need positions too. The scanner is tolerant: it stops at the first text that it
//! does not understand, and the entries found before remain valid.

use std::fmt::Write as _;
use std::ops::Range;

/// One step from a value to a value inside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

/// An entry of a list, struct or map, with its position in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Entry {
    /// The path from the root of the file, e.g. `modules[3].kind.side_m`.
    pub(super) path: String,
    /// Byte range of the whole entry: key, colon and value.
    pub(super) whole: Range<usize>,
    /// Byte range of the value.
    pub(super) value: Range<usize>,
}

/// Everything that an editor of a text needs to know of its structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Outline {
    /// Byte range of the whole value.
    pub(super) root: Range<usize>,
    /// The entries, inner ones before outer ones.
    pub(super) entries: Vec<Entry>,
    /// Byte ranges of strings and block comments: what stands in them is no structure, and a line may begin in one.
    pub(super) opaque: Vec<Range<usize>>,
}

/// The reason why scanning ended early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// More than the allowed number of brackets are open at this byte.
    TooDeep(usize),
    /// The text is not RON; the parser will report what is wrong.
    Malformed,
}

/// Refuses texts with more than `limit` brackets open at once, so that no recursive parser gets them.
pub(super) fn check_depth(text: &str, limit: usize) -> Result<(), Stop> {
    let mut scanner = Scanner::new(text, limit);
    match scanner.document(&mut |_, _, _| {}) {
        Err(Stop::TooDeep(offset)) => Err(Stop::TooDeep(offset)),
        Ok(()) | Err(Stop::Malformed) => Ok(()),
    }
}

/// The entry at `path`, or the nearest enclosing entry that the text contains.
pub(super) fn find(text: &str, limit: usize, path: &str) -> Option<Entry> {
    let mut best: Option<Entry> = None;
    visit(text, limit, &mut |steps, whole, value| {
        let candidate = path_text(steps);
        let encloses = path
            .strip_prefix(candidate.as_str())
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.') || rest.starts_with('['));
        if encloses && best.as_ref().is_none_or(|b| b.path.len() < candidate.len()) {
            best = Some(Entry {
                path: candidate,
                whole,
                value,
            });
        }
    });
    best
}

/// The innermost entry that contains the byte `offset`.
pub(super) fn entry_at(text: &str, limit: usize, offset: usize) -> Option<Entry> {
    let mut best: Option<Entry> = None;
    visit(text, limit, &mut |steps, whole, value| {
        let contains = whole.start <= offset && offset <= whole.end;
        // Inner entries are visited before outer ones, so the first match at a deeper level is kept. Of two
        // neighbours that meet at the offset, the entry that starts there is preferred to the one that ends there.
        let better = best
            .as_ref()
            .is_none_or(|b| whole.len() < b.whole.len() || b.whole.end == offset);
        let around_best = best
            .as_ref()
            .is_some_and(|b| whole.start <= b.whole.start && b.whole.end <= whole.end);
        if contains && better && !around_best {
            best = Some(Entry {
                path: path_text(steps),
                whole,
                value,
            });
        }
    });
    best
}

/// The whole structure of a text.
///
/// # Errors
/// A text that the scanner does not understand to its end.
pub(super) fn outline(text: &str, limit: usize) -> Result<Outline, Stop> {
    let mut scanner = Scanner::new(text, limit);
    let mut entries = Vec::new();
    scanner.document(&mut |steps, whole, value| {
        entries.push(Entry {
            path: path_text(steps),
            whole,
            value,
        });
    })?;
    Ok(Outline {
        root: scanner.root..scanner.position,
        entries,
        opaque: scanner.opaque,
    })
}

/// The byte of the opening bracket of a value that has fields or elements.
pub(super) fn opening(text: &str, value: &Range<usize>) -> Option<usize> {
    let mut scanner = Scanner::new(&text[..value.end], usize::MAX);
    scanner.position = value.start;
    if scanner.raw_hashes().is_some() {
        return None;
    }
    if !matches!(scanner.peek()?, '(' | '[' | '{') {
        scanner.word().ok()?;
        scanner.skip_blank().ok()?;
    }
    let is_open = matches!(scanner.peek()?, '(' | '[' | '{');
    is_open.then_some(scanner.position)
}

type Visitor<'v> = dyn FnMut(&[Step<'_>], Range<usize>, Range<usize>) + 'v;

fn visit(text: &str, limit: usize, visitor: &mut Visitor<'_>) {
    // If scanning stops early, the entries visited before are still used.
    let _stopped = Scanner::new(text, limit).document(visitor);
}

fn path_text(steps: &[Step<'_>]) -> String {
    let mut path = String::new();
    for step in steps {
        match step {
            Step::Key(key) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(key);
            }
            Step::Index(index) => {
                let _infallible = write!(path, "[{index}]");
            }
        }
    }
    path
}

struct Scanner<'a> {
    text: &'a str,
    position: usize,
    limit: usize,
    steps: Vec<Step<'a>>,
    /// First byte of the whole value.
    root: usize,
    opaque: Vec<Range<usize>>,
}

impl<'a> Scanner<'a> {
    fn new(text: &'a str, limit: usize) -> Self {
        Self {
            text,
            position: 0,
            limit,
            steps: Vec::new(),
            root: 0,
            opaque: Vec::new(),
        }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.position..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn skip_past(&mut self, end: &str) -> Result<(), Stop> {
        let length = self.rest().find(end).ok_or(Stop::Malformed)?;
        self.position += length + end.len();
        Ok(())
    }

    fn document(&mut self, visitor: &mut Visitor<'_>) -> Result<(), Stop> {
        self.skip_blank()?;
        while self.rest().starts_with("#!") {
            self.skip_past("]")?;
            self.skip_blank()?;
        }
        self.root = self.position;
        self.value(0, visitor)
    }

    /// Skips white space and comments.
    fn skip_blank(&mut self) -> Result<(), Stop> {
        loop {
            let rest = self.rest();
            self.position += rest.len() - rest.trim_start().len();
            if self.rest().starts_with("//") {
                let rest = self.rest();
                self.position += rest.find('\n').unwrap_or(rest.len());
            } else if self.rest().starts_with("/*") {
                self.block_comment()?;
            } else {
                return Ok(());
            }
        }
    }

    /// Skips a block comment; RON's block comments can be nested.
    fn block_comment(&mut self) -> Result<(), Stop> {
        let (start, mut open) = (self.position, 0_usize);
        loop {
            let rest = self.rest();
            let next = rest
                .find("/*")
                .into_iter()
                .chain(rest.find("*/"))
                .min()
                .ok_or(Stop::Malformed)?;
            self.position += next + 2;
            open = if rest[next..].starts_with("/*") {
                open + 1
            } else {
                open - 1
            };
            if open == 0 {
                self.opaque.push(start..self.position);
                return Ok(());
            }
        }
    }

    fn value(&mut self, depth: usize, visitor: &mut Visitor<'_>) -> Result<(), Stop> {
        match self.peek() {
            None => Err(Stop::Malformed),
            Some('(' | '[' | '{') => self.container(depth, visitor),
            Some('"') => self.string(),
            Some('\'') => self.character(),
            Some('r' | 'b') if self.raw_hashes().is_some() => self.raw_string(),
            Some('b') if self.rest().starts_with("b\"") => {
                self.position += 1;
                self.string()
            }
            Some(_) => {
                let word = self.word()?;
                let after_word = self.position;
                self.skip_blank()?;
                if self.peek() == Some('(') && word.starts_with(|c: char| c.is_alphabetic()) {
                    return self.container(depth, visitor);
                }
                self.position = after_word;
                Ok(())
            }
        }
    }

    /// Reads a number, an identifier or another word without brackets, of at least one character.
    fn word(&mut self) -> Result<&'a str, Stop> {
        let rest = self.rest();
        let end = rest
            .find(|c: char| c.is_whitespace() || ",:()[]{}\"'/".contains(c))
            .unwrap_or(rest.len());
        if end == 0 {
            return Err(Stop::Malformed);
        }
        self.position += end;
        Ok(&rest[..end])
    }

    fn string(&mut self) -> Result<(), Stop> {
        let mut escaped = false;
        for (index, c) in self.rest().char_indices().skip(1) {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    let start = self.position;
                    self.position += index + 1;
                    self.opaque.push(start..self.position);
                    return Ok(());
                }
                _ => {}
            }
        }
        Err(Stop::Malformed)
    }

    fn character(&mut self) -> Result<(), Stop> {
        self.position += 1;
        if self.peek() == Some('\\') {
            self.position += 1;
        }
        self.position += self.peek().map_or(0, char::len_utf8);
        self.skip_past("'")
    }

    /// The number of `#` of the raw string that starts at the position; `None` if no raw string starts here.
    fn raw_hashes(&self) -> Option<usize> {
        let rest = self.rest();
        let rest = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('r')?;
        let hashes = rest.len() - rest.trim_start_matches('#').len();
        rest[hashes..].starts_with('"').then_some(hashes)
    }

    fn raw_string(&mut self) -> Result<(), Stop> {
        let start = self.position;
        let hashes = self.raw_hashes().ok_or(Stop::Malformed)?;
        self.skip_past("\"")?;
        self.skip_past(&format!("\"{}", "#".repeat(hashes)))?;
        self.opaque.push(start..self.position);
        Ok(())
    }

    fn container(&mut self, depth: usize, visitor: &mut Visitor<'_>) -> Result<(), Stop> {
        if depth >= self.limit {
            return Err(Stop::TooDeep(self.position));
        }
        let (close, keyed) = match self.peek() {
            Some('(') => (')', true),
            Some('{') => ('}', true),
            _ => (']', false),
        };
        self.position += 1;
        for index in 0.. {
            self.skip_blank()?;
            if self.peek() == Some(close) {
                break;
            }
            let start = self.position;
            let step = match self.key().filter(|_| keyed) {
                Some(key) => Step::Key(key),
                None => {
                    self.position = start;
                    Step::Index(index)
                }
            };
            self.skip_blank()?;
            let value_start = self.position;
            self.steps.push(step);
            let outcome = self.value(depth + 1, visitor);
            // An unfinished entry is visited too; it ends where scanning stopped.
            visitor(
                &self.steps,
                start..self.position,
                value_start..self.position,
            );
            self.steps.pop();
            outcome?;
            self.skip_blank()?;
            match self.peek() {
                Some(',') => self.position += 1,
                Some(c) if c == close => break,
                _ => return Err(Stop::Malformed),
            }
        }
        self.position += 1;
        Ok(())
    }

    /// Reads a key `name:` or `"name":`, and leaves the position behind the colon.
    fn key(&mut self) -> Option<&'a str> {
        let start = self.position;
        let name = if self.peek() == Some('"') {
            self.string().ok()?;
            self.text[start..self.position].trim_matches('"')
        } else {
            self.word().ok()?
        };
        self.skip_blank().ok()?;
        // A text without a colon is a value, not a key.
        if self.peek() != Some(':') {
            return None;
        }
        self.position += 1;
        Some(name)
    }
}
