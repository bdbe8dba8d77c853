//! A Parquet file of others as the text of a table.

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};

use realgap_core::error::{Error, Result};

/// The columns of a Parquet file, as CSV with their names in the first line: numbers with all their digits, nothing where there is
/// nothing, times as whole numbers of the unit that the file has them in. At most so many rows.
///
/// # Errors
/// Bytes that are no such file, or packed in a way that is not built in; more rows; columns that hold more than one value.
pub fn parquet_table(bytes: Vec<u8>, most_rows: usize) -> Result<String> {
    let refused = |error: ParquetError| {
        Error::invalid("the Parquet file cannot be read")
            .found(error)
            .hint("columns packed with snappy, LZ4 or not at all are read: in pandas, df.to_parquet(FILE, compression=\"snappy\")")
    };
    let file = SerializedFileReader::new(Bytes::from(bytes)).map_err(refused)?;
    let rows = file.metadata().file_metadata().num_rows();
    if usize::try_from(rows).map_or(true, |rows| rows > most_rows) {
        return Err(Error::invalid("too many rows")
            .found(rows)
            .allowed(format!("at most {most_rows}")));
    }
    let fields = file.metadata().file_metadata().schema().get_fields();
    let names: Vec<String> = fields.iter().map(|field| cell(field.name())).collect();
    let mut text = names.join(",");
    text.push('\n');
    for row in file.get_row_iter(None).map_err(refused)? {
        push_row(&mut text, &row.map_err(refused)?)?;
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
        // Several numbers in one cell: `Reading::lists` says what they are.
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
            return Err(Error::invalid("a column holds more than one value a row")
                .field(name)
                .allowed("numbers and texts")
                .hint("write its parts as columns of their own"));
        }
    };
    text.push_str(&value);
    Ok(())
}

/// A text as a cell: on one line, in quotes where it has a comma.
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

    /// Seed of the places where the file is cut.
    const SEED: u64 = 30;

    #[test]
    fn no_cut_of_a_file_reads_as_a_table() {
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
        let text = parquet_table(bytes.clone(), 100).unwrap();
        assert_eq!(text.lines().count(), 101);
        let mut rng = Once::Subset.generator(SEED);
        let cuts = (0..200).map(|_| rng.random_range(0..bytes.len()));
        for length in cuts.chain(bytes.len() - 20..bytes.len()) {
            assert!(parquet_table(bytes[..length].to_vec(), 100).is_err());
        }
    }
}
