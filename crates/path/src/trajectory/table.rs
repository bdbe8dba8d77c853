//! Reads the rows of a CSV text below its header.

use super::column_name::is_row_of_units;
use super::header::{Header, excerpt_list};
use super::reading::{Only, Reading};
use super::sample::{COPY_AGAIN, Layout};
use super::text::{Cell, Separator, cells_of, cut, excerpt};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// A CSV text with its interpreted header.
pub(super) struct Table<'a> {
    pub(super) rows: Rows<'a>,
    pub(super) layout: Layout,
    /// Columns without a role.
    pub(super) unused: Vec<usize>,
    pub(super) group_columns: Vec<usize>,
    pub(super) warnings: Vec<Warning>,
}

impl<'a> Table<'a> {
    pub(super) fn open(text: &'a str, reading: &Reading, group_columns: &[&str]) -> Result<Self> {
        let mut lines = text.lines().enumerate();
        let Some((index, header)) = header_line(&mut lines, reading) else {
            return Err(Error::invalid("the file is empty")
                .at_line(1, 1)
                .allowed("a header such as t_s,x_m,y_m and at least 2 samples")
                .hint(COPY_AGAIN));
        };
        let separator = Separator::of_header(header);
        let mut cells = Vec::new();
        cut(header, index + 1, separator, &mut cells)?;
        if cells.len() > 1 && cells.last().is_some_and(|cell| cell.text.is_empty()) {
            // A separator at the end of the line.
            cells.pop();
        }
        let units = units_below(&mut lines, separator, cells.len());
        let mut columns = Header::new(&cells, units, reading, separator);
        let mut layout = columns.layout(group_columns)?;
        let groups = group_columns
            .iter()
            .map(|name| columns.named(name))
            .collect::<Result<_>>()?;
        let only = match &reading.only {
            Some(only) => Some((columns.named(&only.column)?, only.clone())),
            None => None,
        };
        columns.add_joints(&mut layout);
        columns.must_be_unique()?;
        let mut warnings = columns.warnings();
        let width = cells.len();
        // Files that were appended to each other.
        let again = lines.clone().filter(|(_, line)| *line == header).count();
        if again > 0 {
            warnings.push(Code::ReadAs.warning(format!(
                "the line of names is repeated {}, and is left out there",
                counted(again, "time")
            )));
        }
        Ok(Self {
            unused: columns.unused(),
            rows: Rows {
                lines,
                header,
                cells,
                width,
                separator,
                only,
                others: Vec::new(),
            },
            layout,
            group_columns: groups,
            warnings,
        })
    }
}

/// The characters with which comments begin.
const COMMENTS: [char; 2] = ['#', '%'];

/// The header line after the skipped lines: the first line that is neither blank nor a comment, or the comment above it if that names the
/// columns of a table of numbers. A mark of a comment that stands apart is not a part of the first name.
pub(super) fn header_line<'a>(
    lines: &mut std::iter::Enumerate<std::str::Lines<'a>>,
    reading: &Reading,
) -> Option<(usize, &'a str)> {
    let skipped = reading.skip_lines.unwrap_or(0);
    let mut comment: Option<(usize, &'a str)> = None;
    let mut below = lines.clone();
    while let Some((index, line)) = lines.next() {
        if index < skipped || line.trim().is_empty() {
            continue;
        }
        if line.trim_start().starts_with(COMMENTS) {
            comment = Some((index, line));
            below = lines.clone();
            continue;
        }
        let Some((at, names)) = comment else {
            return Some((index, line));
        };
        let name = bare_comment(names);
        let (names, values) = (cells_of(name), cells_of_like(line, name));
        let is_number = |cell: &&str| Separator::of_header(name).number(cell).is_some();
        let names_columns = names.len() > 1
            && names.len() == values.len()
            && values.iter().any(&is_number)
            && !names.iter().any(is_number);
        if names_columns {
            *lines = below;
            return Some((at, name));
        }
        return Some((index, line));
    }
    comment.map(|(at, names)| (at, bare_comment(names)))
}

/// A comment without its mark, if the mark stands apart: `# t x y`, but not `%time`.
fn bare_comment(line: &str) -> &str {
    let inner = line.trim_start().trim_start_matches(COMMENTS);
    match inner.starts_with(char::is_whitespace) {
        true => inner.trim_start(),
        false => line,
    }
}

/// The cells of a line with the separator of the header.
fn cells_of_like<'a>(line: &'a str, header: &str) -> Vec<&'a str> {
    let mut cells = Vec::new();
    match cut(line, 1, Separator::of_header(header), &mut cells) {
        Ok(()) => cells.iter().map(|cell| cell.text).collect(),
        Err(_) => Vec::new(),
    }
}

/// The cells of a row of units below the header, which is then skipped; empty if there is none.
fn units_below<'a>(
    lines: &mut std::iter::Enumerate<std::str::Lines<'a>>,
    separator: Separator,
    width: usize,
) -> Vec<&'a str> {
    let mut rest = lines.clone();
    let Some((_, line)) = rest.find(|(_, line)| !line.trim().is_empty()) else {
        return Vec::new();
    };
    let mut cells = Vec::new();
    if cut(line, 1, separator, &mut cells).is_err() {
        return Vec::new();
    }
    let is_of_width = cells.len() == width || cells.len() == width + 1;
    if !is_of_width || !is_row_of_units(cells.iter().map(|cell| cell.text)) {
        return Vec::new();
    }
    *lines = rest;
    cells.iter().map(|cell| cell.text).collect()
}

/// The lines below the header.
pub(super) struct Rows<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The line of names, which may be repeated.
    header: &'a str,
    cells: Vec<Cell<'a>>,
    /// The number of columns.
    width: usize,
    separator: Separator,
    /// The column and the value of the robot whose rows are read.
    only: Option<(usize, Only)>,
    /// The values of this column in other rows.
    others: Vec<&'a str>,
}

/// The largest number of other values that are kept for an error message.
const OTHERS: usize = 16;

impl<'a> Rows<'a> {
    /// The next line that is not blank and belongs to the selected robot, with its number from 1.
    pub(super) fn next(&mut self) -> Result<Option<(usize, &[Cell<'a>])>> {
        for (index, line) in self.lines.by_ref() {
            let start = line.trim_start();
            if start.is_empty() || start.starts_with(COMMENTS) || line == self.header {
                continue;
            }
            cut(line, index + 1, self.separator, &mut self.cells)?;
            if self.cells.len() == self.width + 1
                && self.cells.last().is_some_and(|cell| cell.text.is_empty())
            {
                // A separator at the end of the line.
                self.cells.pop();
            }
            if let Some((column, only)) = &self.only {
                let whose = self.cells.get(*column).map_or("", |cell| cell.text);
                let number = |text: &str| text.parse::<f64>().ok();
                let is_same_number = number(whose).is_some_and(|n| number(&only.value) == Some(n));
                if whose != only.value && !is_same_number {
                    if self.others.len() < OTHERS && !self.others.contains(&whose) {
                        self.others.push(whose);
                    }
                    continue;
                }
            }
            return Ok(Some((index + 1, &self.cells)));
        }
        Ok(None)
    }

    /// The error about a selected robot without rows; `None` if no robot was selected.
    pub(super) fn no_matching_robot(&self) -> Option<Error> {
        let (_, only) = self.only.as_ref()?;
        Some(
            Error::invalid(format!(
                "no row has {} = {}",
                excerpt(&only.column),
                excerpt(&only.value)
            ))
            .at_line(1, 1)
            .field("only")
            .allowed(excerpt_list(&self.others)),
        )
    }
}
