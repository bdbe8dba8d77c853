//! Tables as plain text.
//!
//! A [`TextTable`] is what reports print; its columns line up whatever they hold.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

use crate::text::shown;

/// Most characters of a cell.
const LONGEST: usize = 200;

/// On which side of its column a cell stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// Names and text.
    #[default]
    Left,
    /// Numbers.
    Right,
}

/// A column of a table of rows: its name, its side, and what its cell of a row says.
pub type Column<'a, T> = (&'a str, Side, &'a dyn Fn(&T) -> String);

/// A table as plain text: a header line, a row for each entry, columns two blanks apart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TextTable {
    columns: Vec<(String, Side)>,
    rows: Vec<Vec<String>>,
}

impl TextTable {
    /// A table with these columns.
    pub fn new<S: Into<String>>(columns: impl IntoIterator<Item = (S, Side)>) -> Self {
        Self {
            columns: columns
                .into_iter()
                .map(|(name, side)| (name.into(), side))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// A table of some rows: each column says its name, its side and what stands in its cells.
    ///
    /// ```
    /// use realgap_core::table::{Side::{Left, Right}, TextTable};
    /// let rows = [("run_1", 1.23), ("run_2", 12.3)];
    /// let table = TextTable::of(&rows, &[
    ///     ("trajectory", Left, &|row| row.0.to_owned()),
    ///     ("pca", Right, &|row| format!("{} cm", row.1)),
    /// ]);
    /// assert!(table.render(false).ends_with("run_2       12.3 cm\n"));
    /// ```
    pub fn of<'a, T: 'a>(rows: impl IntoIterator<Item = &'a T>, columns: &[Column<'_, T>]) -> Self {
        let mut table = Self::new(columns.iter().map(|(name, side, _)| (*name, *side)));
        for row in rows {
            table.push(columns.iter().map(|(.., cell)| cell(row)));
        }
        table
    }

    /// Adds a row; missing cells stay empty. Of a long cell the start is shown, control characters as escapes.
    pub fn push<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let cells = cells.into_iter().map(|cell| shown(&cell.into(), LONGEST));
        self.rows.push(cells.collect());
    }

    /// The text, each line ended by a line feed; `bold_header` for terminals that understand it.
    ///
    /// ```
    /// use realgap_core::table::{Side, TextTable};
    /// let mut table = TextTable::new([("trajectory", Side::Left), ("pca", Side::Right)]);
    /// table.push(["run_1", "1.23 cm"]);
    /// table.push(["run_2", "12.3 cm"]);
    /// assert_eq!(
    ///     table.render(false),
    ///     "trajectory      pca\n\
    ///      run_1       1.23 cm\n\
    ///      run_2       12.3 cm\n"
    /// );
    /// ```
    pub fn render(&self, bold_header: bool) -> String {
        let mut table = Table::new();
        table.load_style(presets::NOTHING);
        // Never wrap: output that is piped must not depend on the width of a terminal.
        table.set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(self.columns.iter().map(|(name, _)| name));
        for row in &self.rows {
            table.add_row(row);
        }
        for (index, (_, side)) in self.columns.iter().enumerate() {
            if let Some(column) = table.column_mut(index) {
                column.set_padding((0, 2));
                column.set_cell_alignment(match side {
                    Side::Left => CellAlignment::Left,
                    Side::Right => CellAlignment::Right,
                });
            }
        }
        let mut text = String::new();
        for (index, line) in table.lines().enumerate() {
            let line = line.trim_end();
            if index == 0 && bold_header {
                text.push_str(&format!("\u{1b}[1m{line}\u{1b}[0m\n"));
            } else {
                text.push_str(line);
                text.push('\n');
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_right_and_lines_have_no_trailing_blanks() {
        let mut table = TextTable::new([
            ("name", Side::Left),
            ("value", Side::Right),
            ("note", Side::Left),
        ]);
        table.push(["a", "1", "x"]);
        table.push(["längerer Name", "123456", ""]);
        table.push(["short row"]);
        assert_eq!(
            table.render(false),
            "name            value  note\n\
             a                   1  x\n\
             längerer Name  123456\n\
             short row\n"
        );
        assert!(table.render(true).starts_with("\u{1b}[1mname"));
        assert_eq!(TextTable::default().render(false), "");
    }
}
