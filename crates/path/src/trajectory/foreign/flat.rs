//! Builds the table into which a file of another program is converted.

use super::super::format::Decoded;
use super::super::text::{MAX_COLUMNS, MAX_ROWS, Separator, cut};
use realgap_core::error::{Error, Result};
use realgap_core::warning::{Code, Warning};

/// A table in the making: names, rows of cells, and what has to be said about the conversion.
#[derive(Debug, Default)]
pub(super) struct Flat {
    names: Vec<String>,
    text: String,
    rows: usize,
    warnings: Vec<Warning>,
}

impl Flat {
    /// A table with these columns. Names that occur twice get a number, because a file may list a marker again after it was lost.
    ///
    /// # Errors
    /// More columns than can be read.
    pub(super) fn new(names: impl IntoIterator<Item = String>) -> Result<Self> {
        let mut made = Self::default();
        for name in names {
            let plain = plain(&name);
            let mut own = plain.clone();
            let mut count = 1;
            while made.names.contains(&own) {
                count += 1;
                own = numbered(&plain, count);
            }
            made.names.push(own);
        }
        if made.names.len() > MAX_COLUMNS {
            return Err(Error::invalid("too many columns")
                .found(made.names.len())
                .allowed(format!("at most {MAX_COLUMNS}"))
                .hint("export fewer markers or bodies"));
        }
        Ok(made)
    }

    /// Adds a row; line breaks and separators cannot be in a cell.
    ///
    /// # Errors
    /// More rows than can be read.
    pub(super) fn push<S: AsRef<str>>(&mut self, cells: impl IntoIterator<Item = S>) -> Result<()> {
        self.rows += 1;
        if self.rows > MAX_ROWS {
            return Err(Error::invalid("too many rows").allowed(format!("at most {MAX_ROWS}")));
        }
        for (index, cell) in cells.into_iter().enumerate() {
            if index > 0 {
                self.text.push(',');
            }
            self.text.push_str(cell.as_ref());
        }
        self.text.push('\n');
        Ok(())
    }

    /// Says how the file was understood.
    pub(super) fn read_as(&mut self, how: impl Into<String>) {
        self.warnings.push(Code::ReadAs.warning(how.into()));
    }

    /// Says what the file leaves open.
    pub(super) fn doubt(&mut self, doubt: Warning) {
        self.warnings.push(doubt);
    }

    /// Says what is not read.
    pub(super) fn not_read(&mut self, what: impl Into<String>) {
        self.warnings
            .push(Code::ColumnsIgnored.warning(what.into()));
    }

    pub(super) fn decoded(self) -> Decoded {
        Decoded {
            text: format!("{}\n{}", self.names.join(","), self.text),
            warnings: self.warnings,
        }
    }
}

/// A name without characters that separate cells.
pub(super) fn plain(name: &str) -> String {
    let is_apart = |c: char| matches!(c, ',' | ';' | '"' | '\n' | '\r' | '\t');
    name.replace(is_apart, " ").trim().to_owned()
}

/// The name with a number behind its first word, so that the unit stays at its end.
fn numbered(name: &str, count: usize) -> String {
    match name.split_once(' ') {
        Some((first, rest)) => format!("{first}#{count} {rest}"),
        None => format!("{name}#{count}"),
    }
}

/// The cells of a line, without quotes and white space around them.
pub(super) fn cells(line: &str, number: usize, separator: Separator) -> Result<Vec<&str>> {
    let mut cells = Vec::new();
    cut(line, number, separator, &mut cells)?;
    Ok(cells.iter().map(|cell| cell.text).collect())
}

/// A row of a table: the number of its line, and its cells.
pub(super) type Row<'a> = (usize, Vec<&'a str>);

/// The names and the rows of a table with commas; blank lines are left out.
pub(super) fn names_and_rows(
    text: &str,
) -> Result<(Vec<&str>, impl Iterator<Item = Result<Row<'_>>>)> {
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty());
    let names = lines.next().map_or("", |(_, line)| line);
    let names = cells(names, 1, Separator::Comma)?;
    let rows = lines.map(|(index, line)| {
        let number = index + 1;
        Ok((number, cells(line, number, Separator::Comma)?))
    });
    Ok((names, rows))
}

/// The error about a line of a file whose first lines are those of `program`.
pub(super) fn broken(program: &str, line: usize, found: impl std::fmt::Display) -> Error {
    Error::invalid(format!("this is no complete export of {program}"))
        .at_line(line, 1)
        .found(found)
        .hint("export it again, or write a table with one line of names (t_s, x_m, y_m, ...)")
}
