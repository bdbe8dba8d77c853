//! Parses RON and JSON texts into typed values, and translates the parser's errors into plain words.

use ron::error::{Error as Code, SpannedError};
use ron::extensions::Extensions;
use serde::de::DeserializeOwned;

use super::outline::{Entry, Stop, check_depth};
use super::source::{Form, MAX_NESTING, Source};
use super::suggestion::{shorten, unknown_name};
use crate::Error;
use crate::Result;

/// Parses a text into `T`: JSON if the source was made by [`Source::json`], else RON. Optional fields may be written without `Some(...)`.
///
/// # Errors
/// Anything that is not RON or does not fit `T`: the error names file, line, column, field, what
/// was found and what is allowed. Texts nested deeper than [`MAX_NESTING`] are refused.
pub fn parse_ron<T: DeserializeOwned>(source: &Source) -> Result<T> {
    if source.form() == Form::Json {
        return parse_json(source);
    }
    if let Err(Stop::TooDeep(offset)) = check_depth(source.text(), MAX_NESTING) {
        let (line, column) = source.line_column(offset);
        return Err(too_deep().at_file(source.path()).at_line(line, column));
    }
    options()
        .from_str(source.text())
        .map_err(|error| translate(source, &error))
}

fn parse_json<T: DeserializeOwned>(source: &Source) -> Result<T> {
    serde_json::from_str(source.text()).map_err(|error| {
        // The position is removed: JSON texts are written by programs, so a user does not see the lines of the text.
        let message = error.to_string();
        let message = message
            .rsplit_once(" at line ")
            .map_or(&*message, |(message, _)| message);
        Error::from_serde(message).at_file(source.path())
    })
}

/// Writes `value` as RON that people can read: one line per entry of a top-level list.
///
/// # Errors
/// Types that RON cannot express; all types of this project can be expressed.
pub fn write_ron<T: serde::Serialize>(value: &T) -> Result<String> {
    let layout = ron::ser::PrettyConfig::new()
        .depth_limit(2)
        .separate_tuple_members(false)
        .new_line("\n");
    match options().to_string_pretty(value, layout) {
        Ok(text) => Ok(text + "\n"),
        Err(error) => Err(Error::invalid(format!(
            "cannot write this value as RON: {error}"
        ))),
    }
}

fn options() -> ron::Options {
    // The depth is checked before parsing; the parser's own limit is a second safeguard.
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(2 * MAX_NESTING + 8)
}

fn too_deep() -> Error {
    Error::invalid("nested too deeply")
        .allowed(format!("at most {MAX_NESTING} brackets open at once"))
        .hint("look for a bracket that is never closed")
}

/// Translates the parser's error into plain words. The parser gives the position, the outline gives the field at this position.
fn translate(source: &Source, error: &SpannedError) -> Error {
    let start = source.offset(error.span.start.line, error.span.start.col);
    let end = source.offset(error.span.end.line, error.span.end.col);
    let spot = Spot {
        source,
        offset: start,
        entry: source.entry_at(start),
    };
    if let Some(error) = spot.decimal_comma().or_else(|| spot.list_not_closed()) {
        return error;
    }
    match &error.code {
        Code::ExceededRecursionLimit => spot.here(too_deep()),
        Code::NoSuchStructField {
            expected, found, ..
        } => spot.here(unknown_name("field", found, expected.iter().copied())),
        Code::NoSuchEnumVariant {
            expected, found, ..
        } => spot.here(unknown_name("name", found, expected.iter().copied())),
        Code::MissingStructField { field, .. } => spot.in_container(
            Error::invalid(format!("the field `{field}` is missing"))
                .hint(format!("add `{field}: ...`")),
        ),
        Code::DuplicateStructField { .. } => {
            spot.here(Error::invalid("the field is given twice").hint("remove one of the two"))
        }
        Code::ExpectedDifferentLength { expected, found } => spot.in_container(
            Error::invalid("wrong number of values")
                .found(found)
                .allowed(
                    expected
                        .replace("a tuple of size", "a group `( ... )` of")
                        .replace("an array of length", "a group `( ... )` of"),
                ),
        ),
        Code::InvalidValueForType { expected, found } => spot.here(
            Error::invalid("a value of the wrong kind")
                .found(found)
                .allowed(expected),
        ),
        Code::ExpectedDifferentStructName { found, .. } => spot.here(
            Error::invalid("fields must stand in plain brackets")
                .found(found)
                .allowed("( field: value, ... )"),
        ),
        Code::ExpectedStructLike | Code::ExpectedNamedStructLike(_) => spot.group_expected(),
        Code::Message(message) => spot.here(Error::from_serde(message)),
        Code::NoSuchExtension(name) => spot.here(
            Error::invalid("unknown RON extension")
                .found(name)
                .hint("remove the line `#![enable(...)]`; realgap's files need no extension"),
        ),
        code => match expected_kind(code) {
            Some(allowed) => spot.wrong_kind(allowed),
            None => spot.syntax(code, end),
        },
    }
}

/// The kind of value that the parser expected; `None` if the error is not about a kind of value.
fn expected_kind(code: &Code) -> Option<&'static str> {
    Some(match code {
        Code::ExpectedFloat | Code::FloatUnderscore => "a number",
        Code::ExpectedInteger
        | Code::IntegerOutOfBounds
        | Code::UnderscoreAtBeginning
        | Code::InvalidIntegerDigit { .. } => "a whole number",
        Code::ExpectedString => "text in double quotes",
        Code::ExpectedBoolean => "true or false",
        Code::ExpectedArray => "a list `[ ... ]`",
        Code::ExpectedMap => "a map `{ ... }`",
        Code::ExpectedIdentifier | Code::SuggestRawIdentifier(_) | Code::InvalidIdentifier(_) => {
            "a name, without quotes"
        }
        Code::ExpectedOption => "a value",
        Code::ExpectedUnit => "()",
        Code::ExpectedChar => "a character in single quotes",
        _ => return None,
    })
}

/// The position at which the parser stopped, and the entry that contains it.
struct Spot<'a> {
    source: &'a Source,
    offset: usize,
    entry: Option<Entry>,
}

impl Spot<'_> {
    fn here(&self, error: Error) -> Error {
        self.place(error, self.offset, self.entry.as_ref())
    }

    fn place(&self, error: Error, offset: usize, entry: Option<&Entry>) -> Error {
        let (line, column) = self.source.line_column(offset);
        let error = error.at_file(self.source.path()).at_line(line, column);
        match entry {
            Some(entry) => error.field(shorten(&entry.path)),
            None => error,
        }
    }

    /// Places an error about a missing entry at the start of its group. The parser notices a missing entry only at the
    /// closing bracket, just behind the last entry, but a person looks for the group itself.
    fn in_container(&self, error: Error) -> Error {
        let entry = self
            .entry
            .clone()
            .filter(|entry| self.offset < entry.whole.end)
            .or_else(|| {
                let path = &self.entry.as_ref()?.path;
                let parent = path.rfind(['.', '[']).map_or("", |cut| &path[..cut]);
                self.source.find(parent)
            });
        let offset = entry.as_ref().map_or(0, |entry| entry.value.start);
        self.place(error, offset, entry.as_ref())
    }

    /// The error for a decimal comma such as `0,08`, which the parser reads as two entries.
    fn decimal_comma(&self) -> Option<Error> {
        let start = self.entry.as_ref().map_or(self.offset, |e| e.value.start);
        let (before, after) = self.source.text().split_at_checked(start)?;
        let whole = before.strip_suffix(',')?;
        let is_digit = |c: char| c.is_ascii_digit();
        let whole = &whole[whole.trim_end_matches(is_digit).len()..];
        let part = &after[..after.len() - after.trim_start_matches(is_digit).len()];
        (!whole.is_empty() && !part.is_empty()).then(|| {
            let error = Error::invalid("a comma within a number")
                .found(shorten(&format!("{whole},{part}")))
                .allowed(shorten(&format!("{whole}.{part}")))
                .hint("decimals follow a point; a comma begins the next entry");
            let (line, column) = self.source.line_column(start - 1 - whole.len());
            error.at_file(self.source.path()).at_line(line, column)
        })
    }

    /// The error for a list without its closing bracket: a field stands where the next entry of the list should be.
    fn list_not_closed(&self) -> Option<Error> {
        let entry = self.entry.as_ref()?;
        let list = entry.path.strip_suffix(']')?.rsplit_once('[')?.0;
        let start = entry.whole.start;
        let text = self.source.text().get(start..)?;
        let opened = self.source.find(list)?.value.start;
        if !self.source.text().get(opened..)?.starts_with('[') {
            return None;
        }
        if self.source.text().get(self.offset..)?.starts_with(')') && entry.value.is_empty() {
            let error = Error::invalid("a closing `]` is missing")
                .hint("close the list before the `)` that ends its group");
            return Some(self.here(error).field(shorten(list)));
        }
        let name = &text[..text.find(|c: char| !c.is_alphanumeric() && c != '_')?];
        let is_field = text[name.len()..].trim_start().starts_with(':');
        let is_first = entry.path.ends_with("[0]");
        (is_field && !name.is_empty() && !is_first && start <= self.offset).then(|| {
            let error = Error::invalid("a closing `]` is missing")
                .found(format!("the field `{}` within the list", shorten(name)))
                .hint(format!("close the list before `{}`", shorten(name)));
            let (line, column) = self.source.line_column(start);
            let error = error.at_file(self.source.path()).at_line(line, column);
            error.field(shorten(list))
        })
    }

    fn value_text(&self) -> Option<String> {
        let entry = self.entry.as_ref()?;
        let text = self.source.text().get(entry.value.clone())?;
        (!text.is_empty()).then(|| shorten(text))
    }

    fn wrong_kind(&self, allowed: &str) -> Error {
        let error = Error::invalid("a value of the wrong kind").allowed(allowed);
        match (self.value_text(), &self.entry) {
            (Some(found), Some(entry)) => {
                self.place(error.found(found), entry.value.start, Some(entry))
            }
            _ => self.here(error),
        }
    }

    /// The error for a missing group: `Passive` instead of `Passive(...)`, a plain value instead of fields, or an empty file.
    fn group_expected(&self) -> Error {
        if self.source.text().trim().is_empty() {
            return Error::invalid("the file is empty").at_file(self.source.path());
        }
        match self.value_text() {
            Some(name) if name.starts_with(|c: char| c.is_alphabetic()) => self.here(
                Error::invalid(format!("`{name}` needs brackets"))
                    .found(&name)
                    .allowed(format!("{name}(...)"))
                    .hint("the brackets are needed even if no field stands in them"),
            ),
            _ => self.wrong_kind("a group `( ... )`"),
        }
    }

    /// The error for a text that is not valid RON.
    fn syntax(&self, code: &Code, end: usize) -> Error {
        let rest = self.source.text().get(end..).unwrap_or_default();
        let inside_value = self
            .entry
            .as_ref()
            .is_some_and(|e| e.value.start < self.offset && self.offset < e.value.end);
        match code {
            Code::ExpectedStringEnd => self
                .here(Error::invalid("the text never ends").hint("close it with a double quote")),
            Code::UnclosedBlockComment => {
                self.here(Error::invalid("the comment never ends").hint("close it with `*/`"))
            }
            Code::InvalidEscape(_) => self.here(
                Error::invalid("unknown escape in a text")
                    .hint("write a backslash as `\\\\`, a quote as `\\\"`"),
            ),
            Code::TrailingCharacters => self.here(
                Error::invalid("something follows the last closing bracket")
                    .hint("remove it, or look for a superfluous bracket"),
            ),
            _ if rest.trim().is_empty() => self.here(
                Error::invalid("the file ends too early")
                    .hint("look for a bracket that is never closed"),
            ),
            Code::ExpectedComma if inside_value => self
                .wrong_kind("a value that fits here (whole numbers are written without a point)"),
            Code::ExpectedComma => self.here(
                Error::invalid("a comma or a closing bracket is missing")
                    .hint("entries are separated by commas"),
            ),
            Code::ExpectedMapColon => self.here(
                Error::invalid("a colon is missing").hint("fields are written `name: value`"),
            ),
            Code::ExpectedStructLikeEnd | Code::ExpectedOptionEnd => self.here(
                Error::invalid("a closing `)` is missing, or there is one value too many")
                    .hint("decimals follow a point: 0.08, not 0,08"),
            ),
            Code::ExpectedArrayEnd => self.here(Error::invalid("a closing `]` is missing")),
            Code::ExpectedMapEnd => self.here(Error::invalid("a closing `}` is missing")),
            Code::UnexpectedChar(c) => {
                self.here(Error::invalid("an unexpected character").found(format!("{c:?}")))
            }
            other => self.here(Error::invalid(format!("this is not RON: {other}"))),
        }
    }
}
