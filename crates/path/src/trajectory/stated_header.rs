//! Names for the columns of a file whose first line holds values already: the reading states them.

use super::reading::Reading;
use super::stamp::stamp;
use super::text::{Cell, Separator, cut, excerpt};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;

/// The text with the stated names as a line above its first row; unchanged if the reading states none. What follows is one line further down.
///
/// # Errors
/// Another number of names than of columns, a name that holds the separator, or a file that names its columns itself.
pub(super) fn with_stated_header(text: String, reading: &Reading) -> Result<String> {
    let names = &reading.header;
    if names.is_empty() {
        return Ok(text);
    }
    let skipped = reading.skip_lines.unwrap_or(0);
    let is_row = |line: &str| {
        let line = line.trim_start();
        !line.is_empty() && !line.starts_with(['#', '%'])
    };
    let mut lines = text.lines().enumerate();
    let Some((index, row)) = lines.find(|(index, line)| *index >= skipped && is_row(line)) else {
        return Ok(text);
    };
    let separator = separator_of_row(row);
    let mut cells = Vec::new();
    cut(row, index + 1, separator, &mut cells)?;
    if cells.len() == names.len() + 1 && cells.last().is_some_and(|cell| cell.text.is_empty()) {
        cells.pop();
    }
    let refuse = |what: &str| {
        Error::invalid(what.to_owned())
            .at_line(index + 1, 1)
            .field("header")
    };
    if !cells.iter().any(|cell| is_value(cell, separator)) {
        return Err(refuse("the file names its columns itself")
            .found(excerpt(row))
            .hint(
                "leave `header` out, or state with it the names of a file without a line of names",
            )
            .advise(Advice::MapColumns));
    }
    if cells.len() != names.len() {
        return Err(refuse("the names do not fit the columns")
            .found(format!(
                "{} for rows of {}: {}",
                counted(names.len(), "name"),
                counted(cells.len(), "column"),
                excerpt(row)
            ))
            .allowed(format!(
                "{}, in their order; empty names for columns that are not read",
                counted(cells.len(), "name")
            )));
    }
    let joined = joined(names, separator).ok_or_else(|| {
        refuse("a name holds a sign that separates columns here")
            .found(excerpt(&names.join(" ")))
            .allowed("letters, digits, `_` and `.`")
    })?;
    let mut out = String::with_capacity(text.len() + joined.len() + 1);
    for (at, line) in text.lines().enumerate() {
        if at == index {
            out.push_str(&joined);
            out.push('\n');
        }
        out.push_str(line);
        out.push('\n');
    }
    Ok(out)
}

/// The separator of a row of values, where commas may be those of decimal numbers.
pub(super) fn separator_of_row(row: &str) -> Separator {
    if row.contains(';') {
        Separator::Semicolon
    } else if row.contains('\t') {
        Separator::Tab
    } else {
        Separator::of_header(row)
    }
}

/// True if a cell holds a number or a time.
fn is_value(cell: &Cell<'_>, separator: Separator) -> bool {
    separator.number(cell.text).is_some() || stamp(cell.text).is_some()
}

/// The names as a line that is cut with this separator; `None` if it would be cut otherwise.
fn joined(names: &[String], separator: Separator) -> Option<String> {
    let is_blank = |name: &String| name.trim().is_empty();
    // White space cannot stand around an empty name.
    let filled = names
        .iter()
        .enumerate()
        .map(|(index, name)| match is_blank(name) {
            true => format!("not_read_{}", index + 1),
            false => name.trim().to_owned(),
        });
    let line = filled
        .collect::<Vec<_>>()
        .join(&separator.character().to_string());
    let mut cells = Vec::new();
    let is_cut = cut(&line, 1, Separator::of_header(&line), &mut cells).is_ok();
    let is_whole = is_cut && cells.len() == names.len() && Separator::of_header(&line) == separator;
    is_whole.then_some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(text: &str, names: &[&str]) -> Result<String> {
        let reading = Reading {
            header: names.iter().map(|name| (*name).to_owned()).collect(),
            ..Reading::default()
        };
        with_stated_header(text.to_owned(), &reading)
    }

    #[test]
    fn the_names_stand_above_the_first_row_with_its_separator() {
        for (text, expected) in [
            ("0,1,2\n1,1,2\n", "t_s,x_m,y_m\n0,1,2\n1,1,2\n"),
            ("# log\n0 1 2\n", "# log\nt_s x_m y_m\n0 1 2\n"),
            ("0,5;1,5;2,5;\n", "t_s;x_m;y_m\n0,5;1,5;2,5;\n"),
            ("0\t1\t2", "t_s\tx_m\ty_m\n0\t1\t2\n"),
        ] {
            assert_eq!(named(text, &["t_s", "x_m", "y_m"]).unwrap(), expected);
        }
        assert_eq!(
            named("0,a,2\n", &["t_s", "", "x_m"]).unwrap(),
            "t_s,not_read_2,x_m\n0,a,2\n"
        );
    }

    #[test]
    fn names_that_do_not_fit_are_refused() {
        for (text, names, said) in [
            (
                "0,1,2\n",
                ["t_s", "x_m"].as_slice(),
                "2 names for rows of 3 columns",
            ),
            ("0 1\n", &["t s", "x"], "separates columns"),
            ("t,x\n0,1\n", &["t_s", "x_m"], "names its columns itself"),
        ] {
            let error = named(text, names).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
