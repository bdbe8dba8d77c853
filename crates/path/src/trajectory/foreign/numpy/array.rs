//! One array of NumPy: its header, and its numbers as they stand in a table.

use super::super::super::text::push_number;
use realgap_core::error::{Error, Result};
use realgap_core::file::ByteReader;

/// The first bytes of a file.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Names of arrays of three numbers that are a place.
const PLACES: [&str; 5] = ["position", "positions", "pos", "xyz", "translation"];

/// An array of numbers with one row for each sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) rows: usize,
    /// Numbers in each row.
    pub(super) columns: usize,
    /// The numbers row by row; `None` for an array of another shape or type.
    numbers: Option<Vec<Number>>,
    /// Shape and type as the file states them.
    said: String,
}

/// A number as it is printed: whole numbers keep all their digits, because stamps of nanoseconds need them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Whole(i128),
    Real(f64),
}

/// The kind and size of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Kind {
    letter: char,
    size: usize,
    is_big_endian: bool,
}

impl Kind {
    /// Parses e.g. `<f8`; `None` for a type that is no number.
    fn parse(text: &str) -> Option<Self> {
        let mut chars = text.chars();
        let is_big_endian = match chars.next()? {
            '<' | '|' | '=' => false,
            '>' => true,
            _ => return None,
        };
        let letter = chars.next()?;
        let size = chars.as_str().parse().ok()?;
        let is_known = match letter {
            'f' => matches!(size, 2 | 4 | 8),
            'i' | 'u' => matches!(size, 1 | 2 | 4 | 8),
            'b' => size == 1,
            _ => false,
        };
        is_known.then_some(Self {
            letter,
            size,
            is_big_endian,
        })
    }

    fn number(self, bytes: &[u8]) -> Number {
        let mut wide = [0_u8; 8];
        for (index, byte) in bytes.iter().enumerate() {
            let at = match self.is_big_endian {
                true => self.size - 1 - index,
                false => index,
            };
            wide[at] = *byte;
        }
        let raw = u64::from_le_bytes(wide);
        match (self.letter, self.size) {
            ('f', 8) => Number::Real(f64::from_bits(raw)),
            // A number of single precision has the digits that it was written with.
            ('f', 4) => Number::Real(shortest(f32::from_bits(raw as u32))),
            ('f', _) => Number::Real(half(raw as u16)),
            ('i', size) => {
                let unused = 64 - 8 * size as u32;
                Number::Whole(i128::from((raw << unused) as i64 >> unused))
            }
            _ => Number::Whole(i128::from(raw)),
        }
    }
}

/// The number of double precision with the fewest digits that is this number of single precision.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// A number of half precision.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    sign * match exponent {
        0 => fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1024.0 + fraction) * 2f64.powi(exponent - 25),
    }
}

/// What the header of an array states.
struct Header {
    /// Names and types of fields; one without a name for a plain array.
    fields: Vec<(String, String)>,
    is_fortran: bool,
    shape: Vec<usize>,
}

fn broken(name: &str, found: &str) -> Error {
    Error::invalid("this is no whole array of NumPy")
        .field(name)
        .found(found)
        .allowed("an array of numbers that numpy.save or numpy.savez wrote")
}

/// The value behind a key of the header, which is a Python dictionary.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let at = header.find(&format!("'{key}':"))?;
    Some(header[at + key.len() + 3..].trim_start())
}

/// The text between the next two quotes, and what follows it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let text = &text[text.find('\'')? + 1..];
    let end = text.find('\'')?;
    Some((&text[..end], &text[end + 1..]))
}

fn header(text: &str) -> Option<Header> {
    let descr = value(text, "descr")?;
    let mut fields = Vec::new();
    if descr.starts_with('[') {
        let end = descr.find(']')?;
        let mut rest = &descr[..end];
        while let Some((name, after)) = quoted(rest) {
            let (kind, after) = quoted(after)?;
            fields.push((name.to_owned(), kind.to_owned()));
            // A field that is an array itself has its shape behind the type.
            if after.trim_start().starts_with(',') {
                return None;
            }
            rest = after;
        }
    } else {
        fields.push((String::new(), quoted(descr)?.0.to_owned()));
    }
    let shape = value(text, "shape")?.strip_prefix('(')?;
    let shape = &shape[..shape.find(')')?];
    let shape = shape
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty());
    Some(Header {
        fields,
        is_fortran: value(text, "fortran_order")?.starts_with("True"),
        shape: shape.map(|part| part.parse().ok()).collect::<Option<_>>()?,
    })
}

/// The arrays in one file: one, or one for each field of a structured array.
pub(super) fn arrays(name: &str, bytes: &[u8]) -> Result<Vec<Array>> {
    let mut input = ByteReader::new(bytes);
    if input.take(MAGIC.len()) != Some(MAGIC) {
        return Err(broken(name, "other first bytes"));
    }
    let length = match input.array::<2>() {
        Some([1, _]) => input
            .array()
            .map(|two| usize::from(u16::from_le_bytes(two))),
        Some(_) => (input.array()).and_then(|four| usize::try_from(u32::from_le_bytes(four)).ok()),
        None => None,
    };
    let text = length.and_then(|length| input.take(length));
    let text = text.and_then(|text| std::str::from_utf8(text).ok());
    let text = text.ok_or_else(|| broken(name, "no header"))?;
    let Some(header) = header(text) else {
        return Err(broken(name, text.trim()));
    };
    let rows = header.shape.first().copied().unwrap_or(1);
    let columns: Option<usize> = header
        .shape
        .iter()
        .skip(1)
        .try_fold(1, |all: usize, size| all.checked_mul(*size));
    let columns = columns.ok_or_else(|| broken(name, "an endless shape"))?;
    let said = |kind: &str| format!("{kind} of {:?}", header.shape);
    let is_plain = header.fields.len() == 1 && header.fields[0].0.is_empty();
    let is_plain_table = is_plain && header.shape.len() == 2;
    // An array without columns may state any number of rows.
    let is_table = columns > 0 && (header.shape.len() == 1 || is_plain_table);
    let kinds: Option<Vec<Kind>> = header
        .fields
        .iter()
        .map(|(_, kind)| Kind::parse(kind))
        .collect();
    let name_of = |field: &str| match is_plain {
        true => name.to_owned(),
        false => field.to_owned(),
    };
    let Some(kinds) = kinds.filter(|_| is_table) else {
        let all = header.fields.iter().map(|(field, kind)| Array {
            name: name_of(field),
            rows,
            columns,
            numbers: None,
            said: said(kind),
        });
        return Ok(all.collect());
    };
    let width: usize = kinds.iter().map(|kind| kind.size).sum();
    let size = rows
        .checked_mul(columns)
        .and_then(|count| count.checked_mul(width));
    let data = size.and_then(|size| input.take(size));
    let data = data.ok_or_else(|| broken(name, "fewer bytes than its shape says"))?;
    let mut from = 0;
    let mut all = Vec::new();
    for ((field, text), kind) in header.fields.iter().zip(kinds) {
        let number = |index: usize| {
            let at = index * width + from;
            kind.number(&data[at..at + kind.size])
        };
        let index = |row: usize, column: usize| match header.is_fortran {
            true => column * rows + row,
            false => row * columns + column,
        };
        let numbers = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        all.push(Array {
            name: name_of(field),
            rows,
            columns,
            numbers: Some(
                numbers
                    .map(|(row, column)| number(index(row, column)))
                    .collect(),
            ),
            said: said(text),
        });
        from += kind.size;
    }
    Ok(all)
}

impl Array {
    /// True for numbers with one row for each sample.
    pub(super) fn is_of_samples(&self) -> bool {
        self.numbers.is_some() && self.rows > 1 && self.columns > 0
    }

    pub(super) fn words(&self) -> String {
        format!("{} ({})", self.name, self.said)
    }

    fn is_place(&self) -> bool {
        let last = self.name.rsplit(['.', '_']).next().unwrap_or_default();
        self.columns == 3 && PLACES.contains(&last)
    }

    /// The names of its columns in a table.
    pub(super) fn names(&self) -> Vec<String> {
        match self.is_place() {
            true => ["x", "y", "z"]
                .map(|axis| format!("{}.{axis}", self.name))
                .to_vec(),
            false => vec![self.name.clone()],
        }
    }

    /// The cells of a row of a table.
    pub(super) fn cells(&self, row: usize) -> Vec<String> {
        let numbers = self.numbers.as_deref().unwrap_or_default();
        let numbers = numbers.iter().skip(row * self.columns).take(self.columns);
        let cells: Vec<String> = numbers
            .map(|number| match number {
                Number::Whole(value) => value.to_string(),
                Number::Real(value) => {
                    let mut text = String::new();
                    push_number(&mut text, *value);
                    text
                }
            })
            .collect();
        match self.is_place() || self.columns == 1 {
            true => cells,
            false => vec![format!("[{}]", cells.join(" "))],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_type_are_read() {
        let of = |kind: &str, bytes: &[u8]| Kind::parse(kind).map(|kind| kind.number(bytes));
        assert_eq!(of("<f8", &2.5f64.to_le_bytes()), Some(Number::Real(2.5)));
        assert_eq!(of(">f4", &0.1f32.to_be_bytes()), Some(Number::Real(0.1)));
        assert_eq!(of("<f2", &[0x00, 0xc1]), Some(Number::Real(-2.5)));
        assert_eq!(of("<i2", &(-3i16).to_le_bytes()), Some(Number::Whole(-3)));
        let stamp = 1_700_000_000_123_456_789_i64;
        assert_eq!(
            of("<i8", &stamp.to_le_bytes()),
            Some(Number::Whole(i128::from(stamp)))
        );
        assert_eq!(of("|b1", &[1]), Some(Number::Whole(1)));
        assert_eq!(of("<U8", &[]), None);
    }
}
