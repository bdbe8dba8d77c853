//! A text and where it came from.

use std::path::{Path, PathBuf};

use super::hash::sha256;
use super::input::read_limited;
use super::outline::{self, Entry};
use crate::Error;
use crate::Result;

/// Largest file of ours that is read, in bytes (1 MB). Robots and studies are a few kilobytes.
pub const MAX_FILE_BYTES: u64 = 1_000_000;

/// Most brackets that may be open at once. Robots use six.
pub const MAX_NESTING: usize = 32;

/// How a text is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// RON: what people write into files.
    Ron,
    /// JSON: what other programs make of their own objects, with the same fields.
    Json,
}

/// The text of a file, with its path for error messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    path: PathBuf,
    text: String,
    form: Form,
}

/// XML that says that it is UTF-16 or Latin-1 as UTF-8; anything else as it is.
fn xml_as_utf8(bytes: Vec<u8>) -> Vec<u8> {
    let wide = |of: fn([u8; 2]) -> u16| -> Option<String> {
        let pairs = bytes[2..]
            .chunks_exact(2)
            .map(|pair| of([pair[0], pair[1]]));
        let text: Option<String> = char::decode_utf16(pairs)
            .map(std::result::Result::ok)
            .collect();
        let text = text?;
        text.trim_start().starts_with('<').then_some(text)
    };
    let text = match bytes.as_slice() {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ if bytes.starts_with(b"<?xml") => {
            let end = bytes.iter().position(|byte| *byte == b'>').unwrap_or(0);
            let says = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
            let is_latin = says.contains("8859-1\"") || says.contains("8859-1'");
            is_latin.then(|| bytes.iter().map(|byte| char::from(*byte)).collect())
        }
        _ => None,
    };
    text.map_or(bytes, String::into_bytes)
}

impl Source {
    /// A text that is already in memory; `path` is what error messages call it.
    pub fn new(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            text: text.into(),
            form: Form::Ron,
        }
    }

    /// The same fields as JSON, from a program that has them as objects: a variant with fields is an object with its name as the
    /// only key, one without is its name as a text. Errors name no line in it, for nobody has written one.
    ///
    /// ```
    /// use realgap_core::file::{Source, parse_ron};
    ///
    /// #[derive(serde::Deserialize)]
    /// struct Cube {
    ///     side_m: f64,
    /// }
    /// let cube: Cube = parse_ron(&Source::json("cube", r#"{"side_m": 0.1}"#))?;
    /// assert_eq!(cube.side_m, 0.1);
    /// # Ok::<(), realgap_core::Error>(())
    /// ```
    pub fn json(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        Self {
            form: Form::Json,
            ..Self::new(path, text)
        }
    }

    /// Reads the file at `path`; `kind` is what error messages call it, e.g. "morphology".
    ///
    /// # Errors
    /// Missing or unreadable files, folders, more than [`MAX_FILE_BYTES`], and anything that is not UTF-8 text.
    pub fn read(path: impl AsRef<Path>, kind: &str) -> Result<Self> {
        let path = path.as_ref();
        let bytes = read_limited(path, MAX_FILE_BYTES, kind)?;
        Self::from_bytes(path, bytes, kind)
    }

    /// A file's bytes that are already in memory; the same checks as [`Source::read`].
    ///
    /// # Errors
    /// More than [`MAX_FILE_BYTES`], and anything that is not UTF-8 text.
    pub fn from_bytes(path: impl Into<PathBuf>, bytes: Vec<u8>, kind: &str) -> Result<Self> {
        let path = path.into();
        if bytes.len() as u64 > MAX_FILE_BYTES {
            return Err(
                Error::invalid(format!("cannot read the {kind}: the file is too large"))
                    .at_file(&path)
                    .found(format!("more than {MAX_FILE_BYTES} bytes"))
                    .allowed(format!("at most {MAX_FILE_BYTES} bytes"))
                    .hint(format!("is this really a {kind} file?")),
            );
        }
        match String::from_utf8(xml_as_utf8(bytes)) {
            // Some editors of Windows start every file with a byte order mark.
            Ok(text) => Ok(Self::new(
                path,
                match text.strip_prefix('\u{feff}') {
                    Some(rest) => rest.to_owned(),
                    None => text,
                },
            )),
            Err(error) => {
                let good = error.utf8_error().valid_up_to();
                let bytes = error.as_bytes();
                let text = String::from_utf8_lossy(&bytes[..good]);
                let (line, column) = line_column(&text, text.len());
                Err(Error::invalid(format!(
                    "cannot read the {kind}: the file is not UTF-8 text"
                ))
                .at_file(path)
                .at_line(line, column)
                .found(format!("the byte 0x{:02x}", bytes.get(good).unwrap_or(&0)))
                .hint("save it as UTF-8 in a text editor"))
            }
        }
    }

    /// Whether a program has made it, as JSON.
    pub fn is_json(&self) -> bool {
        self.form == Form::Json
    }

    /// The path that error messages name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// SHA-256 of the text as 64 lower-case hexadecimal digits, for provenance.
    pub fn sha256(&self) -> String {
        sha256(&self.text)
    }

    /// Line and column (from 1) of the value at `path`, e.g. `glue[3].child`; of the nearest enclosing
    /// value when the text leaves that one out; `None` when not even the first step is there.
    pub fn locate(&self, path: &str) -> Option<(usize, usize)> {
        self.find(path)
            .map(|entry| line_column(&self.text, entry.value.start))
    }

    /// Whether there is a value at exactly this `path`.
    pub fn has(&self, path: &str) -> bool {
        self.find(path).is_some_and(|entry| entry.path == path)
    }

    /// Adds this file, and the line and column of `path` as in [`Source::locate`], to an error.
    #[must_use]
    pub fn at(&self, path: &str, error: Error) -> Error {
        let error = error.at_file(&self.path);
        match self.locate(path) {
            Some((line, column)) => error.at_line(line, column),
            None => error,
        }
    }

    /// Adds file, line and column of the field that an error names.
    #[must_use]
    pub fn at_field(&self, error: Error) -> Error {
        let field = error.field_name().unwrap_or_default().to_owned();
        self.at(&field, error)
    }

    pub(super) fn form(&self) -> Form {
        self.form
    }

    pub(super) fn find(&self, path: &str) -> Option<Entry> {
        match self.form {
            Form::Ron => outline::find(&self.text, MAX_NESTING, path),
            Form::Json => None,
        }
    }

    pub(super) fn entry_at(&self, offset: usize) -> Option<Entry> {
        outline::entry_at(&self.text, MAX_NESTING, offset)
    }

    pub(super) fn line_column(&self, offset: usize) -> (usize, usize) {
        line_column(&self.text, offset)
    }

    /// The byte at line and column (from 1, columns in characters); the end of the text when beyond it.
    pub(super) fn offset(&self, line: usize, column: usize) -> usize {
        let mut start = 0;
        for (index, text) in self.text.split_inclusive('\n').enumerate() {
            if index + 1 == line {
                let within = text.char_indices().nth(column.saturating_sub(1));
                return start + within.map_or(text.len(), |(offset, _)| offset);
            }
            start += text.len();
        }
        self.text.len()
    }
}

fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = 1 + before.matches('\n').count();
    (line, 1 + before[line_start..].chars().count())
}
