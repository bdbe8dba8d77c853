//! Tables of a folder, as text.

use std::path::Path;

use realgap_core::error::{Error, Result};

/// A CSV file.
#[derive(Debug, Default)]
pub(in crate::report) struct Sheet {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Sheet {
    /// A table of the folder, empty where there is no such file.
    ///
    /// # Errors
    /// A file that is no table.
    pub fn read(folder: &Path, name: &str) -> Result<Self> {
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
    pub fn header(&self) -> Vec<&str> {
        self.header.iter().map(String::as_str).collect()
    }

    /// The rows.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// A column's texts; empty where there is no such column.
    pub fn texts(&self, name: &str) -> Vec<&str> {
        let Some(column) = self.header.iter().position(|known| known == name) else {
            return Vec::new();
        };
        self.rows.iter().map(|row| row[column].as_str()).collect()
    }

    /// A column's numbers; what is none is not a number.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let texts = self.texts(name).into_iter();
        texts.map(|text| text.parse().unwrap_or(f64::NAN)).collect()
    }
}
