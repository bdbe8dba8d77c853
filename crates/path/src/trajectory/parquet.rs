//! The file format Parquet, with columns by name as in a CSV file.

use super::Trajectory;
use super::csv::Csv;
use super::format::{Decoded, Format, Parsed, Rendered};
use super::reading::{QuaternionOrder, Reading};
use super::relabel::relabelled;
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

/// Tables that pandas, Polars, DuckDB and loggers write (<https://parquet.apache.org>).
///
/// Columns have the same names, units, mappings and groups as in [`Csv`]; times of pandas are whole numbers of their unit (`--column 't=time in
/// ns'`). Parquet files can be read but not written, and only by a program that was built with the feature `parquet`. Supported are
/// uncompressed columns and the compressions snappy and LZ4.
#[derive(Debug, Clone, Copy)]
pub struct Parquet;

#[cfg(feature = "parquet")]
fn table(bytes: Vec<u8>) -> Result<String> {
    realgap_store::parquet_table(bytes, super::MAX_ROWS)
}

#[cfg(not(feature = "parquet"))]
fn table(_bytes: Vec<u8>) -> Result<String> {
    Err(Error::invalid("this program was built without Parquet")
        .hint("build it with `cargo install --path . --features parquet`, or write a CSV file"))
}

impl Format for Parquet {
    constant_methods! {
        name: &'static str = "parquet";
        doc: &'static str = "Parquet: columns by name, as in a CSV file (feature `parquet`)";
        extensions: &'static [&'static str] = &["parquet"];
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        relabelled(table(bytes)?, reading).map(Decoded::from)
    }

    fn is_table(&self) -> bool {
        true
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        Csv.parse(text, reading)
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        Csv.parse_split(text, reading)
    }

    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        Csv.applied(text, reading)
    }

    fn order(&self, text: &str, reading: &Reading) -> QuaternionOrder {
        Csv.order(text, reading)
    }

    fn columns<'a>(&self, text: &'a str, reading: &Reading) -> Vec<&'a str> {
        Csv.columns(text, reading)
    }

    fn parse_groups(
        &self,
        text: &str,
        reading: &Reading,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        Csv.parse_groups(text, reading, group_columns)
    }

    fn writes(&self) -> bool {
        false
    }

    fn render(&self, _trajectory: &Trajectory) -> Result<Rendered> {
        Err(Error::usage("Parquet files can be read but not written").allowed("a .csv file"))
    }
}
