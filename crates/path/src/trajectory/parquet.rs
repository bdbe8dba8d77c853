//! The file format Parquet, with columns by name as in a CSV file.

use super::foreign::ForeignTable;
use super::format::Decoded;
#[cfg(not(feature = "parquet"))]
use realgap_core::error::Error;
use realgap_core::error::Result;

/// Tables that pandas, Polars, DuckDB and loggers write (<https://parquet.apache.org>).
///
/// Columns have the same names, units, mappings and groups as in [`Csv`](super::csv::Csv); times of pandas are whole numbers of their unit (`--column 't=time in
/// ns'`). Parquet files can be read but not written, and only by a program that was built with the feature `parquet`. Supported are
/// uncompressed columns and the compressions snappy and LZ4.
pub const PARQUET: ForeignTable = ForeignTable {
    name: "parquet",
    doc: "Parquet: columns by name, as in a CSV file (feature `parquet`)",
    extensions: &["parquet"],
    recognises: |_| false,
    table: |bytes| table(bytes).map(Decoded::from),
};

#[cfg(feature = "parquet")]
fn table(bytes: Vec<u8>) -> Result<String> {
    realgap_store::parquet_table(bytes, super::MAX_ROWS)
}

#[cfg(not(feature = "parquet"))]
fn table(_bytes: Vec<u8>) -> Result<String> {
    Err(Error::invalid("this program was built without Parquet")
        .hint("build it with `cargo install --path . --features parquet`, or write a CSV file"))
}
