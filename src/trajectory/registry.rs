//! The file formats by extension: reading and writing.
//!
//! A new format is one new file that implements [`Format`] and one line in [`FORMATS`]; the
//! contract test in tests/formats.rs runs over all of them.

use std::path::Path;

use super::csv::Csv;
use super::format::{Format, Parsed};
use super::meta::read_meta_beside;
use super::text::{MAX_FILE_BYTES, decode_text, read_text};
use super::tum::Tum;
use super::{Recording, Trajectory};
use crate::error::{Error, Result};
use crate::file::{read_limited, unknown_name, write_atomic};
use crate::unit::LengthUnit;
use crate::warning::Warning;

/// Columns by which recordings in one file are told apart, from the outermost to the innermost.
pub const GROUP_COLUMNS: [&str; 2] = ["condition", "run"];

/// Every known format.
pub const FORMATS: &[&dyn Format] = &[&Csv, &Tum];

/// The format that the extension of `path` names.
///
/// # Errors
/// An unknown extension, or none.
pub fn format_of(path: &Path) -> Result<&'static dyn Format> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let wanted = extension.as_deref().unwrap_or_default();
    FORMATS
        .iter()
        .copied()
        .find(|format| format.extensions().contains(&wanted))
        .ok_or_else(|| {
            let known: Vec<String> = FORMATS
                .iter()
                .flat_map(|format| format.extensions())
                .map(|e| format!(".{e}"))
                .collect();
            let found = extension.map_or_else(|| "no extension".to_owned(), |e| format!(".{e}"));
            let known = known.iter().map(String::as_str);
            unknown_name("kind of trajectory file", &found, known).at_file(path)
        })
}

/// Reads one recording; the extension chooses the format, and a `meta.ron` beside the file is attached.
///
/// Lengths in the file are in `unit`; the result is in metres.
///
/// # Errors
/// Unreadable file, unknown extension, more than [`MAX_FILE_BYTES`], anything that is not a
/// trajectory (with file, line and column), or a broken `meta.ron`.
pub fn read(path: impl AsRef<Path>, unit: LengthUnit) -> Result<Recording> {
    let path = path.as_ref();
    let format = format_of(path)?;
    let text = read_text(path, MAX_FILE_BYTES, "trajectory")?;
    let parsed = format
        .parse(&text, unit)
        .map_err(|error| error.at_file(path))?;
    recording(path, stem(path), parsed)
}

/// Reads every recording in a CSV file with grouping columns, e.g. `condition,run,sample,t_s,x_m,y_m`.
///
/// One recording per combination of the values of `group_columns`, in order of first appearance, named
/// `<file stem>/<value>/<value>...`.
///
/// # Errors
/// As [`read`]; a grouping column that the file lacks; a format that holds one recording only.
pub fn read_groups(
    path: impl AsRef<Path>,
    unit: LengthUnit,
    group_columns: &[&str],
) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    let format = format_of(path)?;
    let text = read_text(path, MAX_FILE_BYTES, "trajectory")?;
    groups(path, format, &text, unit, group_columns)
}

/// Reads whatever is in the file: its groups if it is a CSV file with a column `run`, else one recording.
///
/// # Errors
/// As [`read`].
pub fn read_all(path: impl AsRef<Path>, unit: LengthUnit) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    format_of(path)?;
    parse_all(path, read_bytes(path)?, unit)
}

/// The bytes of a trajectory file, for [`parse_all`] and for hashing: what is hashed is then what is read.
///
/// # Errors
/// A missing or unreadable file, or a folder. No more than one byte above [`MAX_FILE_BYTES`] is read; `parse_all`
/// refuses that.
pub fn read_bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    read_limited(path.as_ref(), MAX_FILE_BYTES, "trajectory")
}

/// As [`read_all`], of the file's bytes that are already in memory; `path` names them and has a `meta.ron` beside it.
///
/// # Errors
/// As [`read_all`].
pub fn parse_all(
    path: impl AsRef<Path>,
    bytes: Vec<u8>,
    unit: LengthUnit,
) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    let format = format_of(path)?;
    let text = decode_text(path, bytes, MAX_FILE_BYTES, "trajectory")?;
    let columns = format.columns(&text);
    let [_, run] = GROUP_COLUMNS;
    if columns.contains(&run) {
        let mut group_columns = GROUP_COLUMNS.to_vec();
        group_columns.retain(|name| columns.contains(name));
        return groups(path, format, &text, unit, &group_columns);
    }
    let parsed = format
        .parse(&text, unit)
        .map_err(|error| error.at_file(path))?;
    Ok(vec![recording(path, stem(path), parsed)?])
}

/// Reads whatever is in the file as repeats in named sets: those of one value of the column `set_column`, told apart by the
/// column `run`. Without a column named, `condition` makes the sets where the file has it (and `run`); everything
/// else is one set without a name.
///
/// # Errors
/// As [`read_all`]; a column that the file does not have, or that is `run` itself.
pub fn read_sets(
    path: impl AsRef<Path>,
    unit: LengthUnit,
    set_column: Option<&str>,
) -> Result<Vec<(String, Recording)>> {
    let path = path.as_ref();
    let [outer, run] = GROUP_COLUMNS;
    let format = format_of(path)?;
    let text = read_text(path, MAX_FILE_BYTES, "trajectory")?;
    let columns = format.columns(&text);
    let has = |name: &str| columns.contains(&name);
    let set_column = match set_column {
        Some(column) if column == run => {
            return Err(
                Error::usage("the column `run` tells the repeats of one set apart")
                    .field("group")
                    .allowed("a column whose values are shared by several runs, e.g. condition"),
            );
        }
        Some(column) => {
            for needed in [column, run] {
                if !has(needed) {
                    return Err(unknown_name("column to group the runs by", needed, columns.iter().copied())
                        .at_file(path)
                        .field("group")
                        .or_hint("grouped recordings are rows such as condition,run,t_s,x_m,y_m: one column names the set, `run` the repeat"));
                }
            }
            Some(column)
        }
        None => Some(outer).filter(|outer| has(outer) && has(run)),
    };
    let Some(column) = set_column else {
        let all = parse_all(path, text.into_bytes(), unit)?;
        return Ok(all.into_iter().map(|r| (String::new(), r)).collect());
    };
    format
        .parse_groups(&text, unit, &[column, run])
        .map_err(|error| error.at_file(path))?
        .into_iter()
        .map(|(key, parsed)| {
            let name = format!("{}/{}", stem(path), key.join("/"));
            Ok((key[0].clone(), recording(path, name, parsed)?))
        })
        .collect()
}

fn groups(
    path: &Path,
    format: &dyn Format,
    text: &str,
    unit: LengthUnit,
    group_columns: &[&str],
) -> Result<Vec<Recording>> {
    format
        .parse_groups(text, unit, group_columns)
        .map_err(|error| error.at_file(path))?
        .into_iter()
        .map(|(key, parsed)| recording(path, format!("{}/{}", stem(path), key.join("/")), parsed))
        .collect()
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default()
}

fn recording(path: &Path, name: String, parsed: Parsed) -> Result<Recording> {
    Ok(Recording {
        name,
        path: path.to_path_buf(),
        trajectory: parsed.trajectory,
        meta: read_meta_beside(path)?,
        warnings: parsed.warnings,
    })
}

/// Writes `trajectory` to `path`, in metres; the extension chooses the format.
///
/// The file appears whole or not at all: it is written under another name in the same folder, then
/// renamed. The warnings name what the format cannot hold.
///
/// # Errors
/// Unknown extension, unwritable folder, full disk.
pub fn write(path: impl AsRef<Path>, trajectory: &Trajectory) -> Result<Vec<Warning>> {
    let path = path.as_ref();
    let rendered = format_of(path)?.render(trajectory);
    write_atomic(path, rendered.text.as_bytes())?;
    Ok(rendered.warnings)
}
