//! Arrays of NumPy: `.npy` holds one array, `.npz` several with names in a ZIP archive.
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

mod array;

use super::ForeignTable;
use super::flat::Flat;
use crate::trajectory::format::Decoded;
use array::{Array, arrays};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::file::read_zip;

/// One array of NumPy: a structured array, whose fields have names. Columns without names are refused.
pub const NPY: ForeignTable = ForeignTable {
    name: "npy",
    doc: "a structured array of NumPy, whose fields have names",
    extensions: &["npy"],
    recognises: |bytes| bytes.starts_with(array::MAGIC),
    table: |bytes, _| table(arrays("array", &bytes)?),
    beside: None,
};

/// Arrays of NumPy with names, as `numpy.savez` and `numpy.savez_compressed` write them. An array of several numbers for each sample becomes
/// a list, or NAME.x, NAME.y, NAME.z where its name is that of a place.
pub const NPZ: ForeignTable = ForeignTable {
    name: "npz",
    doc: "arrays of NumPy with names: one number, or one list of numbers, for each sample",
    extensions: &["npz"],
    recognises: |bytes| bytes.starts_with(b"PK"),
    beside: None,
    table: |bytes, _| {
        let mut all = Vec::new();
        for (name, bytes) in read_zip(&bytes)? {
            if let Some(name) = name.strip_suffix(".npy") {
                all.extend(arrays(name, &bytes)?);
            }
        }
        table(all)
    },
};

/// Arrays of the same length as a table; others are named in a warning.
fn table(all: Vec<Array>) -> Result<Decoded> {
    let rows = all.iter().filter(|array| array.is_of_samples());
    // Arrays of samples have one length; parameters and shapes of the robot have others.
    let is_time = |array: &&Array| {
        let lower = array.name.to_lowercase();
        lower.split(|c: char| !c.is_ascii_alphabetic()).any(|word| {
            matches!(
                word,
                "t" | "time" | "times" | "timestamp" | "timestamps" | "stamp"
            )
        })
    };
    let times = rows.clone().find(is_time).map(|array| array.rows);
    let longest = rows.clone().map(|array| array.rows).max();
    let Some(count) = times.or(longest).filter(|count| *count > 1) else {
        let found: Vec<String> = all.iter().map(Array::words).collect();
        return Err(Error::invalid("the file holds no arrays with one row for each sample")
            .found(match found.is_empty() {
                true => "no array of numbers".to_owned(),
                false => found.join(", "),
            })
            .allowed("numbers, with times in an array of its own, e.g. numpy.savez(\"run.npz\", t_s=t, x_m=x, y_m=y)"));
    };
    let (used, left): (Vec<&Array>, Vec<&Array>) = all
        .iter()
        .partition(|array| array.is_of_samples() && array.rows == count);
    if let [only] = used.as_slice()
        && only.columns > 1
    {
        return Err(Error::invalid("the columns of the array have no names")
            .field(&only.name)
            .found(only.words())
            .allowed("named arrays of one length, e.g. numpy.savez(\"run.npz\", t_s=a[:, 0], x_m=a[:, 1], y_m=a[:, 2])")
            .advise(Advice::MapColumns));
    }
    let mut flat = Flat::new(used.iter().flat_map(|array| array.names()))?;
    if !left.is_empty() {
        let words: Vec<String> = left.iter().map(|array| array.words()).collect();
        flat.not_read(format!(
            "arrays that are not read, because they do not have {count} rows of numbers: {}",
            words.join(", ")
        ));
    }
    for row in 0..count {
        flat.push(used.iter().flat_map(|array| array.cells(row)))?;
    }
    Ok(flat.decoded())
}
