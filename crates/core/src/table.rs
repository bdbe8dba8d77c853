//! Tables as plain text, as reports print them.
//!
//! The columns of a [`TextTable`] are aligned whatever the cells hold.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

use crate::text::shown;

/// The largest number of characters of a cell.
const LONGEST: usize = 200;
/// The largest number of characters of a line, as far as its words allow; a usual terminal has at least as many columns.
const WIDEST: usize = 80;
/// Blanks between columns.
const BETWEEN: usize = 2;
/// Text at the end of a row is folded to no fewer characters than this.
const NARROWEST_TEXT: usize = 24;

/// The side of its column to which a cell is aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// Names and text.
    #[default]
    Left,
    /// Numbers.
    Right,
}

/// A column of a table of rows: its name, its side, and the function that gives the text of its cell from a row.
pub type Column<'a, T> = (&'a str, Side, &'a dyn Fn(&T) -> String);

/// A table as plain text: a header line, a row for each entry, two blanks between columns. A table wider than 80 characters first wraps
/// its header, then the text at the end of its rows; if it is still too wide, the remaining columns follow in a second table below, which
/// repeats the first column.
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

    /// A table of some rows; each column gives its name, its side and the text of its cells.
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

    /// Adds a row; missing cells stay empty. A long cell is cut to its start; control characters are shown as escapes.
    pub fn push<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        let cells = cells.into_iter().map(|cell| shown(&cell.into(), LONGEST));
        self.rows.push(cells.collect());
    }

    /// The text of the table, each line ended by a line feed; `bold_header` prints the header bold, for terminals that support it.
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
        let parts = self.parts();
        let parts: Vec<String> = parts.iter().map(|part| part.text(bold_header)).collect();
        parts.join("\n")
    }

    /// The width of each column, in characters.
    fn widths(&self) -> Vec<usize> {
        let names = self.columns.iter().map(|(name, _)| width(name));
        let widths = names.enumerate().map(|(index, name)| {
            let cells = self.rows.iter().filter_map(|row| row.get(index));
            cells.map(|cell| width(cell)).fold(name, usize::max)
        });
        widths.collect()
    }

    /// This table, or its columns divided over as many tables as are needed for each to fit into a line.
    fn parts(&self) -> Vec<Self> {
        if across(&self.widths()) <= WIDEST {
            return vec![self.clone()];
        }
        let mut table = self.clone();
        table.fold_header();
        let whole = table.clone();
        table.fold_text();
        let widths = whole.widths();
        if across(&table.widths()) <= WIDEST || widths.len() <= 2 {
            return vec![table];
        }
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for index in 1..widths.len() {
            let fits = |part: &&mut Vec<usize>| {
                let columns = part.iter().chain([&index]).map(|&column| widths[column]);
                across(&columns.collect::<Vec<_>>()) <= WIDEST
            };
            match parts.last_mut().filter(fits) {
                Some(part) => part.push(index),
                None => parts.push(vec![0, index]),
            }
        }
        let parts = parts.iter().map(|part| self.with_columns(part));
        parts.flat_map(|part| part.parts()).collect()
    }

    /// The table with only the columns of these indices.
    fn with_columns(&self, columns: &[usize]) -> Self {
        let cells = |row: &Vec<String>| {
            let cell = |&index: &usize| row.get(index).cloned().unwrap_or_default();
            columns.iter().map(cell).collect()
        };
        Self {
            columns: columns.iter().map(|&i| self.columns[i].clone()).collect(),
            rows: self.rows.iter().map(cells).collect(),
        }
    }

    /// Wraps the names of columns that are wider than their cells; the remaining width goes to the names with the most lines.
    fn fold_header(&mut self) {
        let body = Self {
            columns: vec![Default::default(); self.columns.len()],
            rows: std::mem::take(&mut self.rows),
        };
        let words = |name: &str| name.split(' ').map(width).max().unwrap_or(0);
        let names = self.columns.iter().map(|(name, _)| words(name));
        let mut widths: Vec<usize> = names.zip(body.widths()).map(|(a, b)| a.max(b)).collect();
        let lines =
            |index: usize, most: usize| folded(&self.columns[index].0, most).lines().count();
        while across(&widths) < WIDEST {
            let tallest = (0..widths.len()).max_by_key(|&index| lines(index, widths[index]));
            match tallest.filter(|&index| lines(index, widths[index]) > 1) {
                Some(index) => widths[index] += 1,
                None => break,
            }
        }
        for ((name, _), width) in self.columns.iter_mut().zip(widths) {
            *name = folded(name, width);
        }
        self.rows = body.rows;
    }

    /// Wraps the text in the last column, if the other columns leave at least [`NARROWEST_TEXT`] characters for it.
    fn fold_text(&mut self) {
        let widths = self.widths();
        let last = widths.len() - 1;
        let rest = WIDEST.saturating_sub(across(&widths) - widths[last]);
        if self.columns[last].1 == Side::Left && rest >= NARROWEST_TEXT {
            for cell in self.rows.iter_mut().filter_map(|row| row.get_mut(last)) {
                *cell = folded(cell, rest);
            }
        }
    }

    /// The text of the table in its full width.
    fn text(&self, bold_header: bool) -> String {
        let mut table = Table::new();
        table.load_style(presets::NOTHING);
        // The width of the terminal is not used: output that is piped must not depend on it.
        table.set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(self.columns.iter().map(|(name, _)| name));
        for row in &self.rows {
            table.add_row(row);
        }
        for (index, (_, side)) in self.columns.iter().enumerate() {
            if let Some(column) = table.column_mut(index) {
                column.set_padding((0, BETWEEN as u16));
                column.set_cell_alignment(match side {
                    Side::Left => CellAlignment::Left,
                    Side::Right => CellAlignment::Right,
                });
            }
        }
        let names = self.columns.iter().map(|(name, _)| name.lines().count());
        let header = names.max().unwrap_or(0);
        let mut text = String::new();
        for (index, line) in table.lines().enumerate() {
            let line = line.trim_end();
            if index < header && bold_header {
                text.push_str(&format!("\u{1b}[1m{line}\u{1b}[0m\n"));
            } else {
                text.push_str(line);
                text.push('\n');
            }
        }
        text
    }
}

/// The number of characters of the longest line of a cell.
fn width(cell: &str) -> usize {
    let lines = cell.lines().map(|line| line.chars().count());
    lines.max().unwrap_or(0)
}

/// The number of characters of a line of columns with these widths.
fn across(widths: &[usize]) -> usize {
    widths.iter().sum::<usize>() + BETWEEN * widths.len().saturating_sub(1)
}

/// The text wrapped into lines of at most `most` characters, broken at blanks only.
fn folded(text: &str, most: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if width(line) + 1 + width(word) <= most => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_right_and_lines_have_no_trailing_blanks() {
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

    #[test]
    fn no_line_is_wider_than_a_terminal() {
        let names = ["metric", "a long name of it", "share", "what is said"];
        let mut table = TextTable::new(names.map(|name| (name, Side::Left)));
        table.push([
            "rms",
            "1.23 cm",
            "12 %",
            &"nothing of this is new ".repeat(4),
        ]);
        assert_eq!(
            table.render(false),
            "metric  a long   share  what is said\n\
             \u{20}       name of\n\
             \u{20}       it\n\
             rms     1.23 cm  12 %   nothing of this is new nothing of this is new nothing of\n\
             \u{20}                       this is new nothing of this is new\n"
        );
        assert_eq!(table.render(true).matches("\u{1b}[1m").count(), 3);
        // Numbers are never wrapped: columns that do not fit follow in a table below.
        let mut table = TextTable::new((0..30).map(|run| (format!("run_{run:02}"), Side::Right)));
        table.push((0..30).map(|run| format!("{run}.25 cm")));
        let text = table.render(false);
        assert!(text.lines().all(|line| width(line) <= WIDEST), "{text}");
        assert_eq!(text.matches("run_00").count(), 4);
        assert!((0..30).all(|run| text.contains(&format!("{run}.25 cm"))));
        assert!(text.lines().filter(|line| line.is_empty()).count() == 3);
    }
}
