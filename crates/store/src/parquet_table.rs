//! Reads a Parquet file of another program as CSV text.

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader as _, RowGroupReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use parquet::schema::types::{Type, TypePtr};

use super::parquet_pages::Group;
use realgap_core::error::{Error, Result};

/// The columns of a Parquet file as CSV with their names in the first line: numbers with all their digits, an empty cell for a missing
/// value, times as whole numbers in the file's own unit. At most `most_rows` rows are read, without the columns that are `left_out`.
///
/// # Errors
/// Bytes that are not a Parquet file, or that use an unsupported compression; more rows; columns with more than one value per row.
pub fn parquet_table(
    bytes: Vec<u8>,
    most_rows: usize,
    left_out: &dyn Fn(&str) -> bool,
) -> Result<String> {
    let refused = |error: ParquetError| {
        Error::invalid("the Parquet file cannot be read")
            .found(error)
            .hint("supported are uncompressed columns and the compressions zstd, snappy and LZ4: in pandas, df.to_parquet(FILE, compression=\"snappy\")")
    };
    let bytes = Bytes::from(bytes);
    let file = SerializedFileReader::new(bytes.clone()).map_err(refused)?;
    let rows = file.metadata().file_metadata().num_rows();
    if usize::try_from(rows).map_or(true, |rows| rows > most_rows) {
        return Err(Error::invalid("too many rows")
            .found(rows)
            .allowed(format!("at most {most_rows}")));
    }
    let schema = file.metadata().file_metadata().schema();
    let fields = schema.get_fields().iter();
    let fields: Vec<TypePtr> = fields
        .filter(|field| !left_out(field.name()))
        .cloned()
        .collect();
    let names: Vec<String> = fields.iter().map(|field| cell(field.name())).collect();
    let kept = Type::group_type_builder(schema.name()).with_fields(fields);
    let kept = kept.build().map_err(refused)?;
    let mut text = names.join(",");
    text.push('\n');
    for group in file.metadata().row_groups() {
        let group = Group::new(bytes.clone(), group);
        for row in group.get_row_iter(Some(kept.clone())).map_err(refused)? {
            push_row(&mut text, &row.map_err(refused)?)?;
        }
    }
    Ok(text)
}

fn push_row(text: &mut String, row: &Row) -> Result<()> {
    for (index, (name, field)) in row.get_column_iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        push_field(text, name, field)?;
    }
    text.push('\n');
    Ok(())
}

fn push_field(text: &mut String, name: &str, field: &Field) -> Result<()> {
    let value = match field {
        Field::Null => String::new(),
        Field::Double(value) => value.to_string(),
        Field::Float(value) => value.to_string(),
        Field::Float16(value) => value.to_string(),
        Field::Bool(value) => value.to_string(),
        Field::Byte(value) => value.to_string(),
        Field::Short(value) => value.to_string(),
        Field::Int(value) => value.to_string(),
        Field::Long(value) => value.to_string(),
        Field::UByte(value) => value.to_string(),
        Field::UShort(value) => value.to_string(),
        Field::UInt(value) => value.to_string(),
        Field::ULong(value) => value.to_string(),
        Field::TimestampMillis(value) | Field::TimestampMicros(value) => value.to_string(),
        Field::Str(value) => cell(value),
        // A list of numbers in one cell; `Reading::lists` says what the numbers mean.
        Field::ListInternal(list) => {
            text.push_str("\"[");
            for (index, element) in list.elements().iter().enumerate() {
                if index > 0 {
                    text.push(',');
                }
                push_field(text, name, element)?;
            }
            "]\"".to_owned()
        }
        _ => {
            return Err(Error::invalid("a column holds more than one value per row")
                .field(name)
                .allowed("numbers and texts")
                .hint("write its parts as separate columns"));
        }
    };
    text.push_str(&value);
    Ok(())
}

/// A text as a CSV cell: on one line, in quotes if it contains a comma.
fn cell(text: &str) -> String {
    let plain: String = text
        .chars()
        .map(|c| match c {
            '"' => '\'',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect();
    if plain.contains(',') {
        format!("\"{plain}\"")
    } else {
        plain
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::data_type::DoubleType;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use rand::RngExt;
    use realgap_core::random::Once;

    use super::parquet_table;

    /// The seed for the positions where the file is cut.
    const SEED: u64 = 30;

    #[test]
    fn a_truncated_file_is_refused_wherever_it_is_cut() {
        let schema = "message rows { required double t_s; required double x_m; }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let values: Vec<f64> = (0..100).map(f64::from).collect();
        while let Some(mut column) = group.next_column().unwrap() {
            let open = column.typed::<DoubleType>();
            open.write_batch(&values, None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        writer.close().unwrap();
        let text = parquet_table(bytes.clone(), 100, &|_| false).unwrap();
        assert_eq!(text.lines().count(), 101);
        let mut rng = Once::Subset.generator(SEED);
        let cuts = (0..200).map(|_| rng.random_range(0..bytes.len()));
        for length in cuts.chain(bytes.len() - 20..bytes.len()) {
            assert!(parquet_table(bytes[..length].to_vec(), 100, &|_| false).is_err());
        }
    }
}
