//! Writes a table as a Parquet file, which pandas, Polars, DuckDB and R read with its column types.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::listing::{Cell, ColumnKind, Listing};
use realgap_core::error::{Error, Result};

/// The listing as the bytes of a Parquet file; `path` names the file in error messages.
///
/// # Errors
/// A table that the format cannot hold.
pub fn to_parquet(listing: &Listing, path: &Path) -> Result<Vec<u8>> {
    encode(listing).map_err(|e| Error::invalid(format!("cannot write Parquet: {e}")).at_file(path))
}

fn encode(listing: &Listing) -> std::result::Result<Vec<u8>, ParquetError> {
    let fields = listing.columns.iter().map(|column| {
        let name = column.name.as_str();
        let field = match column.kind {
            ColumnKind::Whole => Type::primitive_type_builder(name, Physical::INT64)
                .with_repetition(Repetition::REQUIRED),
            ColumnKind::Number => Type::primitive_type_builder(name, Physical::DOUBLE)
                .with_repetition(Repetition::OPTIONAL),
            ColumnKind::Text => Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
                .with_repetition(Repetition::REQUIRED)
                .with_logical_type(Some(LogicalType::String)),
        };
        field.build().map(Arc::new)
    });
    let schema = Type::group_type_builder("rows")
        .with_fields(fields.collect::<std::result::Result<_, _>>()?)
        .build()?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), properties)?;
    let mut group = writer.next_row_group()?;
    let mut column = 0;
    while let Some(mut open) = group.next_column()? {
        let cells = listing.rows.iter().map(|row| &row[column]);
        match listing.columns[column].kind {
            ColumnKind::Whole => {
                let values: Vec<i64> = cells
                    .filter_map(|cell| match cell {
                        Cell::Whole(value) => Some(*value),
                        _ => None,
                    })
                    .collect();
                open.typed::<Int64Type>().write_batch(&values, None, None)?;
            }
            ColumnKind::Number => {
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
            ColumnKind::Text => {
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
