//! Reads text files of numbers within limits, and splits their lines into cells that know their line and column.

use realgap_core::error::{Advice, Error, Result};

/// The size of the largest recording that is read, in bytes (256 MB).
pub const MAX_FILE_BYTES: u64 = 256_000_000;

/// The largest number of samples in one recording: more than two hours at 592 Hz.
pub const MAX_ROWS: usize = 5_000_000;

/// The largest number of columns in one line; realgap's own files have at most 14, without joints.
pub const MAX_COLUMNS: usize = 1_000;

/// Refuses more than [`MAX_FILE_BYTES`].
pub(super) fn check_size(bytes: &[u8]) -> Result<()> {
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(
            Error::invalid("cannot read the trajectory: the file is too large")
                .found(format!("more than {MAX_FILE_BYTES} bytes"))
                .allowed(format!("at most {MAX_FILE_BYTES} bytes"))
                .hint("split it, or record at a lower rate"),
        );
    }
    Ok(())
}

/// The text in the bytes of a file, without a byte order mark.
///
/// # Errors
/// Bytes that are not UTF-8 (with line and column).
pub(super) fn decode_text(mut bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
    if let Some(text) = utf_16(&bytes) {
        return text;
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..good]);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
        Error::invalid("cannot read the trajectory: the file is not UTF-8 text")
            .at_line(line, column)
            .hint("save it as UTF-8 text")
    })
}

/// The text of a file in UTF-16, as spreadsheets and Windows programs write it; `None` for other files.
fn utf_16(bytes: &[u8]) -> Option<Result<String>> {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return None,
    };
    let (pairs, rest) = bytes[2..].as_chunks::<2>();
    let units: Vec<u16> = pairs.iter().map(|pair| unit(*pair)).collect();
    let text = String::from_utf16(&units).ok().filter(|_| rest.is_empty());
    Some(text.ok_or_else(|| {
        Error::invalid("cannot read the trajectory: the file begins as UTF-16 text and is none")
            .hint("save it as UTF-8 text")
    }))
}

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The first line that is not blank, from at most the first 4096 bytes of a file that may not be text.
pub(super) fn first_line(bytes: &[u8]) -> &str {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let start = &bytes[..bytes.len().min(4096)];
    let text = match std::str::from_utf8(start) {
        Ok(text) => text,
        Err(error) => std::str::from_utf8(&start[..error.valid_up_to()]).unwrap_or_default(),
    };
    let mut lines = text.lines().map(str::trim);
    lines.find(|line| !line.is_empty()).unwrap_or_default()
}

/// One cell of a line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell<'a> {
    pub(super) text: &'a str,
    line_text: &'a str,
    start: usize,
    line: usize,
    separator: Separator,
}

impl Cell<'_> {
    /// Adds line and column (both from 1, counted in characters) to an error.
    pub(super) fn locate(&self, error: Error) -> Error {
        let column = self.line_text[..self.start].chars().count() + 1;
        error.at_line(self.line, column)
    }

    /// True if the tracker has written no number or no finite number, because it had lost the body.
    pub(super) fn is_lost(&self) -> bool {
        let nothing = ["", "-", "na", "n/a", "null", "none"];
        nothing
            .iter()
            .any(|word| self.text.eq_ignore_ascii_case(word))
            || self
                .text
                .parse::<f64>()
                .is_ok_and(|value| !value.is_finite())
    }

    /// The value as a finite number.
    pub(super) fn number(&self, field: &str) -> Result<f64> {
        match self.separator.number(self.text) {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(self.locate(
                Error::invalid("not a finite number")
                    .field(field)
                    .found(excerpt(self.text))
                    .allowed("a finite number")
                    .hint("the tracker has lost this sample")
                    .advise(Advice::SkipLost),
            )),
            None if self.is_lost() => Err(self.locate(
                Error::invalid("a number is missing")
                    .field(field)
                    .found(if self.text.is_empty() {
                        "nothing".to_owned()
                    } else {
                        excerpt(self.text)
                    })
                    .allowed("a number such as 0.25 or 2.5e-1")
                    .hint("the tracker has lost this sample")
                    .advise(Advice::SkipLost),
            )),
            None => Err(self.locate(
                Error::invalid("not a number")
                    .field(field)
                    .found(excerpt(self.text))
                    .allowed("a number such as 0.25 or 2.5e-1"),
            )),
        }
    }
}

/// At most 40 characters of `text`, for messages.
pub(super) fn excerpt(text: &str) -> String {
    if text.chars().count() <= 40 {
        text.to_owned()
    } else {
        text.chars().take(37).collect::<String>() + "..."
    }
}

/// The separator of the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// One comma; cells may be quoted.
    Comma,
    /// One semicolon, which spreadsheets write in countries with a decimal comma.
    Semicolon,
    /// One tab.
    Tab,
    /// Any amount of white space.
    Space,
}

impl Separator {
    /// The separator of a header line: a comma if the line contains one, else a semicolon, a tab or a space; but a semicolon if there are
    /// more of them than commas, which then stand inside of names.
    pub(super) fn of_header(line: &str) -> Self {
        let count = |separator: char| line.matches(separator).count();
        let commas = count(',');
        if commas > 0 && commas >= count(';') {
            Self::Comma
        } else if line.contains(';') {
            Self::Semicolon
        } else if line.contains('\t') {
            Self::Tab
        } else if line.trim().contains(' ') && !line.contains('"') {
            Self::Space
        } else {
            Self::Comma
        }
    }

    pub(super) fn character(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
            Self::Space => ' ',
        }
    }

    /// The number in a cell; a decimal comma is accepted if commas do not separate cells.
    pub(super) fn number(self, text: &str) -> Option<f64> {
        let number = text.parse().ok();
        match self {
            Self::Semicolon | Self::Tab if number.is_none() && text.matches(',').count() == 1 => {
                text.replacen(',', ".", 1).parse().ok()
            }
            _ => number,
        }
    }
}

/// Splits line number `line` (from 1) into `cells`, which is cleared first.
pub(super) fn cut<'a>(
    line_text: &'a str,
    line: usize,
    separator: Separator,
    cells: &mut Vec<Cell<'a>>,
) -> Result<()> {
    cells.clear();
    let mut rest = 0;
    while let Some((range, next)) = next_cell(line_text, rest, separator) {
        let raw = &line_text[range.clone()];
        let trimmed = raw.trim();
        let mut start = range.start + (raw.len() - raw.trim_start().len());
        let mut text = trimmed;
        if separator != Separator::Space
            && let Some(inner) = trimmed
                .strip_prefix('"')
                .and_then(|inner| inner.strip_suffix('"'))
        {
            text = inner;
            start += 1;
        }
        let cell = Cell {
            text,
            line_text,
            start,
            line,
            separator,
        };
        if cells.len() == MAX_COLUMNS {
            return Err(cell.locate(
                Error::invalid("too many columns")
                    .allowed(format!("at most {MAX_COLUMNS} columns")),
            ));
        }
        cells.push(cell);
        match next {
            Some(next) => rest = next,
            None => break,
        }
    }
    Ok(())
}

/// The byte range of the cell that begins at or after `from`, and the start of the next cell.
fn next_cell(
    line: &str,
    from: usize,
    separator: Separator,
) -> Option<(std::ops::Range<usize>, Option<usize>)> {
    let rest = &line[from..];
    match separator {
        Separator::Space => {
            let start = from + rest.find(|c: char| !c.is_whitespace())?;
            let end = line[start..]
                .find(char::is_whitespace)
                .map_or(line.len(), |length| start + length);
            Some((start..end, Some(end)))
        }
        Separator::Comma | Separator::Semicolon | Separator::Tab => {
            let mut quoted = false;
            let end = rest.find(|c: char| {
                quoted ^= c == '"';
                c == separator.character() && !quoted
            });
            Some(match end {
                Some(length) => (from..from + length, Some(from + length + 1)),
                None => (from..line.len(), None),
            })
        }
    }
}

/// The texts of the cells of a line; empty if the line has too many columns.
pub(super) fn cells_of(line: &str) -> Vec<&str> {
    let mut cells = Vec::new();
    match cut(line, 1, Separator::of_header(line), &mut cells) {
        Ok(()) => cells.iter().map(|cell| cell.text).collect(),
        Err(_) => Vec::new(),
    }
}

/// Refuses more than [`MAX_ROWS`] rows.
pub(super) fn check_rows(rows: usize, line: usize) -> Result<()> {
    if rows >= MAX_ROWS {
        return Err(Error::invalid("too many rows")
            .at_line(line, 1)
            .allowed(format!("at most {MAX_ROWS} samples in one file"))
            .hint("record at a lower rate, or split the file"));
    }
    Ok(())
}

/// Writes the shortest text that is parsed to exactly the same number.
pub(super) fn push_number(out: &mut String, value: f64) {
    use std::fmt::Write as _;
    let size = value.abs();
    // Writing into a `String` cannot fail.
    let _infallible = if value == 0.0 || (1e-5..1e16).contains(&size) {
        write!(out, "{value}")
    } else {
        write!(out, "{value:e}")
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_knows_its_column_in_characters() {
        let mut cells = Vec::new();
        cut("µm, \"b\" ,oops", 7, Separator::Comma, &mut cells).unwrap();
        assert_eq!(
            cells.iter().map(|c| c.text).collect::<Vec<_>>(),
            ["µm", "b", "oops"]
        );
        let error = cells[2].number("x_m").unwrap_err();
        assert_eq!(error.line_column(), Some((7, 10)));
    }

    #[test]
    fn a_comma_inside_quotes_does_not_separate() {
        let mut cells = Vec::new();
        cut("\"a,b\",2,", 1, Separator::Comma, &mut cells).unwrap();
        assert_eq!(
            cells.iter().map(|c| c.text).collect::<Vec<_>>(),
            ["a,b", "2", ""]
        );
    }

    #[test]
    fn white_space_separates_in_any_amount() {
        let mut cells = Vec::new();
        cut("  1 \t 2  3 ", 1, Separator::Space, &mut cells).unwrap();
        assert_eq!(
            cells.iter().map(|c| c.text).collect::<Vec<_>>(),
            ["1", "2", "3"]
        );
    }

    #[test]
    fn numbers_are_short_and_read_back_exactly() {
        for (value, text) in [(0.1, "0.1"), (1.0, "1"), (-0.0, "-0"), (1e-300, "1e-300")] {
            let mut out = String::new();
            push_number(&mut out, value);
            assert_eq!(out, text);
            assert_eq!(
                out.parse::<f64>().map(f64::to_bits),
                Ok(f64::to_bits(value))
            );
        }
    }

    #[test]
    fn a_line_of_endless_columns_is_refused() {
        let line = "1,".repeat(MAX_COLUMNS + 1);
        assert!(cut(&line, 1, Separator::Comma, &mut Vec::new()).is_err());
    }
}
