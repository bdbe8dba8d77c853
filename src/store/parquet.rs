//! A table as a Parquet file, which pandas, Polars, DuckDB and R read without being told the types.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::listing::{Cell, Listing};
use crate::error::{Error, Result};

/// The listing as the bytes of a Parquet file; `path` is for messages.
///
/// # Errors
/// A table that the format cannot hold.
pub fn to_parquet(listing: &Listing, per_recording: bool, path: &Path) -> Result<Vec<u8>> {
    encode(listing, per_recording)
        .map_err(|e| Error::invalid(format!("cannot write Parquet: {e}")).at_file(path))
}

fn encode(listing: &Listing, per_recording: bool) -> std::result::Result<Vec<u8>, ParquetError> {
    let names = listing.columns(per_recording);
    let rows: Vec<Vec<Cell>> = listing.cells(per_recording).collect();
    let fields = names.iter().enumerate().map(|(column, name)| {
        let field = match kind(listing, column) {
            Kind::Whole => Type::primitive_type_builder(name, Physical::INT64)
                .with_repetition(Repetition::REQUIRED),
            Kind::Number => Type::primitive_type_builder(name, Physical::DOUBLE)
                .with_repetition(Repetition::OPTIONAL),
            Kind::Text => Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
                .with_repetition(Repetition::REQUIRED)
                .with_logical_type(Some(LogicalType::String)),
        };
        field.build().map(Arc::new)
    });
    let schema = Type::group_type_builder("trials")
        .with_fields(fields.collect::<std::result::Result<_, _>>()?)
        .build()?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), properties)?;
    let mut group = writer.next_row_group()?;
    let mut column = 0;
    while let Some(mut open) = group.next_column()? {
        let cells = rows.iter().map(|row| &row[column]);
        match kind(listing, column) {
            Kind::Whole => {
                let values: Vec<i64> = cells
                    .filter_map(|cell| match cell {
                        Cell::Whole(value) => Some(*value),
                        _ => None,
                    })
                    .collect();
                open.typed::<Int64Type>().write_batch(&values, None, None)?;
            }
            Kind::Number => {
                let numbers: Vec<Option<f64>> = cells
                    .map(|cell| match cell {
                        Cell::Number(value) => *value,
                        _ => None,
                    })
                    .collect();
                let values: Vec<f64> = numbers.iter().copied().flatten().collect();
                let defined: Vec<i16> = numbers.iter().map(|n| i16::from(n.is_some())).collect();
                open.typed::<DoubleType>()
                    .write_batch(&values, Some(&defined), None)?;
            }
            Kind::Text => {
                let values: Vec<ByteArray> = cells
                    .map(|cell| ByteArray::from(cell.text().into_bytes()))
                    .collect();
                open.typed::<ByteArrayType>()
                    .write_batch(&values, None, None)?;
            }
        }
        open.close()?;
        column += 1;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

enum Kind {
    Whole,
    Number,
    Text,
}

/// What a column of [`Listing::columns`] holds.
fn kind(listing: &Listing, column: usize) -> Kind {
    let after = column.checked_sub(1 + listing.parameters.len());
    match (column, after) {
        (0, _) => Kind::Whole,
        (_, Some(1 | 2)) => Kind::Text,
        _ => Kind::Number,
    }
}
