//! The file format Parquet, with columns by name as in a CSV file; data sets of LeRobot, which consist of such files.

use super::foreign::ForeignTable;
use super::format::Decoded;
use super::lerobot;
use super::reading::Reading;
#[cfg(not(feature = "parquet"))]
use realgap_core::error::Error;
use realgap_core::error::Result;

/// Tables that pandas, Polars, DuckDB and loggers write (<https://parquet.apache.org>), and the data sets of LeRobot.
///
/// Columns have the same names, units, mappings and groups as in [`Csv`](super::csv::Csv); times of pandas are whole numbers of their unit
/// (`--column 't=time in ns'`). Parquet files can be read but not written, and only by a program that was built with the feature
/// `parquet`, as it is by default. Supported are uncompressed columns and the compressions zstd, snappy and LZ4.
pub const PARQUET: ForeignTable = ForeignTable {
    name: "parquet",
    doc: "Parquet: columns by name, as in a CSV file; a file or the folder of a LeRobot data set (feature `parquet`)",
    extensions: &["parquet"],
    recognises: |_| false,
    table,
    beside: Some(lerobot::bytes),
};

fn table(bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
    match lerobot::decoded(&bytes, reading, &rows)? {
        Some(decoded) => Ok(decoded),
        None => rows(bytes, &|_| false).map(Decoded::from),
    }
}

#[cfg(feature = "parquet")]
fn rows(bytes: Vec<u8>, left_out: &dyn Fn(&str) -> bool) -> Result<String> {
    realgap_store::parquet_table(bytes, super::MAX_ROWS, left_out)
}

#[cfg(not(feature = "parquet"))]
fn rows(_bytes: Vec<u8>, _left_out: &dyn Fn(&str) -> bool) -> Result<String> {
    Err(Error::invalid("this program was built without Parquet")
        .hint("build it with its default features, or write a CSV file"))
}
