//! Reads a CSV log with a header: columns by name, cells as numbers, errors with their line.

use std::path::{Path, PathBuf};

use super::read_limited;
use crate::error::{Error, Result};
use crate::text::shown;

/// The size of the largest log that is read, in bytes (256 MB).
const MAX_BYTES: u64 = 256_000_000;
/// The largest number of rows of a log.
const MAX_ROWS: usize = 5_000_000;

/// A log that was read: its header and its rows of text cells.
pub struct LogTable {
    path: PathBuf,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// Reads the text of the log at `path`.
///
/// # Errors
/// A missing file, a folder, more than 256 MB, bytes that are not UTF-8.
pub fn read_log_text(path: &Path) -> Result<String> {
    let bytes = read_limited(path, MAX_BYTES, "log")?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Error::invalid("cannot read the log: the file is too large")
            .at_file(path)
            .allowed(format!("at most {MAX_BYTES} bytes")));
    }
    String::from_utf8(bytes).map_err(|_| {
        Error::invalid("cannot read the log: the file is not UTF-8 text")
            .at_file(path)
            .hint("save it as UTF-8 text")
    })
}

impl LogTable {
    /// Parses a table whose first line names its columns.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let fail = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            let what = match error.kind() {
                csv::ErrorKind::UnequalLengths {
                    expected_len, len, ..
                } => Error::invalid("a row whose number of cells differs from the header's")
                    .found(len)
                    .allowed(expected_len),
                _ => Error::invalid(format!("this is not CSV: {error}")),
            };
            what.at_file(path).at_line(line as usize, 1)
        };
        let header: Vec<String> = reader
            .headers()
            .map_err(fail)?
            .iter()
            .map(str::to_owned)
            .collect();
        if header.iter().all(String::is_empty) {
            return Err(Error::invalid("the log is empty")
                .at_file(path)
                .allowed("CSV with the names of its columns in the first line"));
        }
        let mut rows = Vec::new();
        for row in reader.records() {
            if rows.len() == MAX_ROWS {
                return Err(Error::invalid("too many rows")
                    .at_file(path)
                    .allowed(format!("at most {MAX_ROWS}")));
            }
            rows.push(row.map_err(fail)?);
        }
        Ok(Self {
            path: path.to_path_buf(),
            header,
            rows,
        })
    }

    /// The names of the columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The number of rows.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// The index of the column with this name; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// The index of the column with this name.
    ///
    /// # Errors
    /// No such column; `hint` tells the user which columns the log should hold.
    pub fn require(&self, name: &str, hint: &str) -> Result<usize> {
        self.column(name).ok_or_else(|| {
            Error::invalid(format!("the log has no column `{name}`"))
                .at_file(&self.path)
                .at_line(1, 1)
                .found(shown(&self.header.join(", "), 200))
                .hint(hint)
        })
    }

    /// The rows in which the column `name` holds the wanted text (all rows if `wanted` is `None`), and the different texts that occur in
    /// this column.
    ///
    /// # Errors
    /// A wanted text without such a column, or no row with the wanted text; a log without rows.
    pub fn chosen(&self, name: &str, wanted: Option<&str>) -> Result<(Vec<usize>, Vec<&str>)> {
        let column = self.column(name);
        if let (Some(wanted), None) = (wanted, column) {
            let error = Error::invalid(format!("the log has no column `{name}`"));
            return Err(error.at_file(&self.path).field(name).found(wanted));
        }
        let (mut rows, mut texts) = (Vec::new(), Vec::new());
        for row in 0..self.row_count() {
            let found = column.map(|column| self.text(row, column));
            if let Some(found) = found.filter(|found| !texts.contains(found)) {
                texts.push(found);
            }
            if wanted.is_none_or(|wanted| found == Some(wanted)) {
                rows.push(row);
            }
        }
        if !rows.is_empty() {
            return Ok((rows, texts));
        }
        let error =
            Error::invalid("the log has no readings: there are no rows").at_file(&self.path);
        Err(match wanted {
            Some(wanted) => error.field(name).found(wanted).allowed(texts.join(", ")),
            None => error,
        })
    }

    /// The cell of a row in a column, without white space around it.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].get(column).unwrap_or_default()
    }

    /// Adds the file and the line of a row to an error.
    pub fn at(&self, row: usize, error: Error) -> Error {
        let line = self.rows[row].position().map_or(1, csv::Position::line);
        error.at_file(&self.path).at_line(line as usize, 1)
    }

    /// The cell as a number; `None` if the cell is empty or holds a number that is not finite (`nan`, `inf`).
    ///
    /// # Errors
    /// Any other text that is not a number.
    pub fn optional(&self, row: usize, column: usize) -> Result<Option<f64>> {
        let text = self.text(row, column);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(value) => Ok(value.is_finite().then_some(value)),
            Err(_) => Err(self.at(
                row,
                Error::invalid("not a number")
                    .field(&self.header[column])
                    .found(shown(text, 40))
                    .allowed("a number, or an empty cell if there was no reading"),
            )),
        }
    }

    /// The cell as a finite number.
    ///
    /// # Errors
    /// An empty cell, or any text that is not a finite number.
    pub fn number(&self, row: usize, column: usize) -> Result<f64> {
        self.optional(row, column)?.ok_or_else(|| {
            self.at(
                row,
                Error::invalid("not a finite number")
                    .field(&self.header[column])
                    .found(match self.text(row, column) {
                        "" => "nothing".to_owned(),
                        text => shown(text, 40),
                    })
                    .allowed("a finite number"),
            )
        })
    }
}
