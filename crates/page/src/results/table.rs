//! Tables of a results folder: CSV files, the same bytes for the same results, however they were computed.

use std::path::Path;

use realgap_core::error::{Error, Result};
use realgap_core::file::write_atomic;
use realgap_core::text::cell;

/// A table as it stands in a CSV file. A command makes it once, writes it, and hands it to the page; `realgap report` reads
/// the file into the same value.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CsvTable {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl CsvTable {
    /// A table of these columns and rows. A text that a spreadsheet would take for a formula is marked as text.
    pub(crate) fn new(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Self {
        let safe = |row: Vec<String>| row.iter().map(|text| cell(text).into_owned()).collect();
        Self {
            header: header.iter().map(|name| (*name).to_owned()).collect(),
            rows: rows.map(safe).collect(),
        }
    }

    /// Writes the table as a CSV file.
    ///
    /// # Errors
    /// A full disk or an unwritable folder.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let fail = |e: &dyn std::fmt::Display| {
            Error::invalid(format!("cannot write the table: {e}")).at_file(path)
        };
        writer.write_record(&self.header).map_err(|e| fail(&e))?;
        for row in &self.rows {
            writer.write_record(row).map_err(|e| fail(&e))?;
        }
        write_atomic(path, &writer.into_inner().map_err(|e| fail(&e))?)
    }

    /// The table in a file of the folder; an empty one where there is no such file.
    ///
    /// # Errors
    /// A file that is no table.
    pub(crate) fn read(folder: &Path, name: &str) -> Result<Self> {
        let path = folder.join(name);
        if !path.is_file() {
            return Ok(Self::default());
        }
        let fail =
            |e: csv::Error| Error::invalid(format!("cannot read the table: {e}")).at_file(&path);
        let mut reader = csv::Reader::from_path(&path).map_err(fail)?;
        let texts = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let header = texts(reader.headers().map_err(fail)?);
        let rows = reader.records().map(|row| row.map(|row| texts(&row)));
        let rows = rows.collect::<std::result::Result<_, _>>().map_err(fail)?;
        Ok(Self { header, rows })
    }

    /// Names of the columns.
    pub(crate) fn header(&self) -> Vec<&str> {
        self.header.iter().map(String::as_str).collect()
    }

    /// The rows.
    pub(crate) fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The position of a column.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|known| known == name)
    }

    /// The texts of a column; empty where there is no such column.
    pub(crate) fn texts(&self, name: &str) -> Vec<&str> {
        let Some(column) = self.column(name) else {
            return Vec::new();
        };
        self.rows.iter().map(|row| row[column].as_str()).collect()
    }

    /// The numbers of a column; a cell without a number becomes NaN.
    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        let texts = self.texts(name).into_iter();
        texts.map(|text| text.parse().unwrap_or(f64::NAN)).collect()
    }
}

/// Each value as [`number`].
pub(super) fn texts(values: &[f64]) -> Vec<String> {
    values.iter().map(f64::to_string).collect()
}

/// Shortest text that reads back to the same bits; empty where there is no number.
pub(super) fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_that_is_read_back_is_the_table_that_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let rows = [["=1+1", "0.1"], ["a \"b\", c", ""]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        let table = CsvTable::new(&["name", "value"], rows.into_iter());
        table.write(&folder.path().join("t.csv")).unwrap();
        assert_eq!(CsvTable::read(folder.path(), "t.csv").unwrap(), table);
        assert_eq!(table.texts("name")[0], "'=1+1");
        let numbers = table.numbers("value");
        assert!(numbers[0] == 0.1 && numbers[1].is_nan());
        let missing = CsvTable::read(folder.path(), "missing.csv").unwrap();
        assert_eq!(missing, CsvTable::default());
    }
}
