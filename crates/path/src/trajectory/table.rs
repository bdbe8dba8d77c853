//! Reads the rows of a CSV text below its header.

use super::header::{Header, excerpt_list};
use super::reading::{Only, Reading};
use super::sample::{COPY_AGAIN, Layout};
use super::text::{Cell, Separator, cut, excerpt};
use realgap_core::error::{Error, Result};
use realgap_core::warning::Warning;

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
        let mut columns = Header::new(&cells, reading, separator)?;
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
        let warnings = columns.ignored_warning().into_iter().collect();
        Ok(Self {
            unused: columns.unused(),
            rows: Rows {
                lines,
                cells,
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

/// The header line: the first line that is not blank after the skipped lines.
pub(super) fn header_line<'a>(
    lines: &mut std::iter::Enumerate<std::str::Lines<'a>>,
    reading: &Reading,
) -> Option<(usize, &'a str)> {
    let skipped = reading.skip_lines.unwrap_or(0);
    lines.find(|(index, line)| *index >= skipped && !line.trim().is_empty())
}

/// The lines below the header.
pub(super) struct Rows<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    cells: Vec<Cell<'a>>,
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
            if line.trim().is_empty() {
                continue;
            }
            cut(line, index + 1, self.separator, &mut self.cells)?;
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
