//! Files in place of inline arrays: CSV with a row of names, and `npz` as numpy writes it.

use std::collections::BTreeMap;
use std::path::Path;

/// Name of the column of times.
const TIMES: &str = "t_s";
/// Endings and names of a local file within a zip archive.
const LOCAL_FILE: [u8; 4] = *b"PK\x03\x04";
/// Length of the fixed part of the header of a local file.
const LOCAL_HEADER: usize = 30;

/// Times and channels of a file.
pub(crate) type Columns = (Option<Vec<f64>>, BTreeMap<String, Vec<f64>>);

/// Reads the channels of a file.
///
/// # Errors
/// Why it cannot be read, in words that follow `answered`.
pub(crate) fn read(path: &Path) -> Result<Columns, String> {
    let shown = path.display();
    let bytes = std::fs::read(path)
        .map_err(|error| format!("a file that cannot be read: {shown}: {error}"))?;
    let all = match path.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => of_csv(&bytes),
        Some("npz") => of_npz(&bytes),
        _ => Err("neither .csv nor .npz".to_owned()),
    };
    let mut all =
        all.map_err(|why| format!("a file that is not as it should be: {shown}: {why}"))?;
    Ok((all.remove(TIMES), all))
}

fn of_csv(bytes: &[u8]) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let names = reader.headers().map_err(|error| error.to_string())?.clone();
    let mut columns = vec![Vec::new(); names.len()];
    for row in reader.records() {
        let row = row.map_err(|error| error.to_string())?;
        for (column, cell) in columns.iter_mut().zip(&row) {
            let number = cell.parse::<f64>();
            column.push(number.map_err(|_| format!("`{cell}` is no number"))?);
        }
    }
    Ok(names.iter().map(str::to_owned).zip(columns).collect())
}

/// The arrays of an archive that `numpy.savez` wrote: each file of it is an array.
fn of_npz(bytes: &[u8]) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let mut all = BTreeMap::new();
    let mut rest = bytes;
    while rest.starts_with(&LOCAL_FILE) {
        let number = |at: usize, length: usize| -> Result<u64, String> {
            let bytes = rest.get(at..at + length).ok_or("it ends within a header")?;
            Ok(bytes
                .iter()
                .rev()
                .fold(0, |value, byte| value << 8 | u64::from(*byte)))
        };
        let (flags, method) = (number(6, 2)?, number(8, 2)?);
        let (mut size, name_length, extra_length) = (
            number(18, 4)?,
            number(26, 2)? as usize,
            number(28, 2)? as usize,
        );
        if method != 0 {
            return Err(
                "its arrays are compressed; write them with numpy.savez, not savez_compressed"
                    .to_owned(),
            );
        }
        let name_end = LOCAL_HEADER + name_length;
        let name = rest
            .get(LOCAL_HEADER..name_end)
            .ok_or("it ends within a name")?;
        // Numpy writes sizes of 64 bits: a field of the header, number 1, with the size before and after packing.
        if size == u64::from(u32::MAX) {
            size = number(name_end + 4 + 8, 8)?;
        }
        if flags & 8 != 0 {
            return Err("it was written as a stream".to_owned());
        }
        let from = name_end + extra_length;
        let to = usize::try_from(size)
            .ok()
            .and_then(|size| from.checked_add(size));
        let array = to
            .and_then(|to| rest.get(from..to))
            .ok_or("it ends within an array")?;
        let name = String::from_utf8_lossy(name);
        let name = name.trim_end_matches(".npy");
        let values = of_npy(array).map_err(|why| format!("array `{name}`: {why}"))?;
        all.insert(name.to_owned(), values);
        rest = &rest[from + array.len()..];
    }
    match all.is_empty() {
        true => Err("no archive of numpy".to_owned()),
        false => Ok(all),
    }
}

/// The numbers of one array of one dimension.
fn of_npy(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let broken = "no array of numpy";
    let version = *bytes
        .strip_prefix(b"\x93NUMPY")
        .and_then(|rest| rest.first())
        .ok_or(broken)?;
    let (length, from) = match version {
        1 => (
            bytes
                .get(8..10)
                .map(|b| usize::from(b[0]) | usize::from(b[1]) << 8),
            10,
        ),
        _ => (
            bytes
                .get(8..12)
                .map(|b| b.iter().rev().fold(0, |v, b| v << 8 | usize::from(*b))),
            12,
        ),
    };
    let to = from + length.ok_or(broken)?;
    let header = bytes.get(from..to).ok_or(broken)?;
    let header: String = String::from_utf8_lossy(header).split_whitespace().collect();
    let data = &bytes[to..];
    let shape = header
        .split("'shape':(")
        .nth(1)
        .and_then(|rest| rest.split(')').next());
    if shape.is_none_or(|shape| shape.trim_end_matches(',').contains(',')) {
        return Err("it has not one dimension".to_owned());
    }
    let values = if header.contains("'descr':'<f8'") {
        data.as_chunks::<8>()
            .0
            .iter()
            .map(|b| f64::from_le_bytes(*b))
            .collect()
    } else if header.contains("'descr':'<f4'") {
        data.as_chunks::<4>()
            .0
            .iter()
            .map(|b| f64::from(f32::from_le_bytes(*b)))
            .collect()
    } else {
        return Err("its numbers are neither float64 nor float32".to_owned());
    };
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_by_its_names() {
        let all = of_csv(b"t_s, x_m\n0, 1\n0.5, 2e-1\n").unwrap();
        assert_eq!(all["t_s"], [0.0, 0.5]);
        assert_eq!(all["x_m"], [1.0, 0.2]);
        assert!(of_csv(b"t_s\nlater\n").unwrap_err().contains("`later`"));
    }

    #[test]
    fn an_array_of_numpy_is_read() {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
        let mut array = b"\x93NUMPY\x01\x00".to_vec();
        array.extend((header.len() as u16).to_le_bytes());
        array.extend(header.as_bytes());
        array.extend([1.5_f64, -2.0].iter().flat_map(|v| v.to_le_bytes()));
        assert_eq!(of_npy(&array).unwrap(), [1.5, -2.0]);
        let mut archive = b"PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0".to_vec();
        archive.extend((array.len() as u32).to_le_bytes());
        archive.extend((array.len() as u32).to_le_bytes());
        archive.extend(7_u16.to_le_bytes());
        archive.extend(0_u16.to_le_bytes());
        archive.extend(b"t_s.npy");
        archive.extend(&array);
        assert_eq!(of_npz(&archive).unwrap()["t_s"], [1.5, -2.0]);
        assert!(of_npz(&archive[..60]).is_err());
    }
}
