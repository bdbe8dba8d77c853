//! The data sets of LeRobot (versions 2 and 3): Parquet files in `data/`, and `meta/info.json`, which names the numbers in their lists.
//!
//! Format: <https://huggingface.co/docs/lerobot/lerobot-dataset-v3>. A data set does not say in which unit its joints are. Where the
//! calibration of the robot lies beside `info.json`, the counts of the encoders tell: degrees from the middle of the range are whole
//! or half steps of the encoder, and shares of the range are whole steps from its end.

mod calibration;

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::Reading;
use super::format::Decoded;
use super::relabel::{numbers, split};
use calibration::{Calibration, Scale};
use realgap_core::error::{Error, Result};
use realgap_core::file::read_limited;
use realgap_core::unit::counted;
use realgap_core::warning::Code;

/// The first bytes of a data set in memory: its files behind each other.
const MAGIC: &[u8] = b"realgap: files of a LeRobot data set\n";
const INFO: &str = "meta/info.json";
/// Where the robot's calibration is looked for: LeRobot writes it elsewhere.
const CALIBRATION: &str = "meta/calibration.json";
/// The folders between a data set and its Parquet files, at most.
const DEPTH: usize = 4;
/// Columns that count rows and tasks.
const COUNTERS: [&str; 3] = ["index", "frame_index", "task_index"];

/// True if this folder is a data set of LeRobot.
pub fn is_data_set(path: &Path) -> bool {
    path.join(INFO).is_file() && path.join("data").is_dir()
}

/// The data set in whose folder `data` this file is.
fn data_set_of(file: &Path) -> Option<&Path> {
    let mut above = file.ancestors().skip(1).take(DEPTH);
    above.find(|folder| is_data_set(folder) && file.starts_with(folder.join("data")))
}

fn parquet_files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let fail = |e: std::io::Error| Error::io("look for the data set's files", folder, &e);
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(fail)?);
        if kind.is_dir() {
            parquet_files(&path, found)?;
        } else if path
            .extension()
            .is_some_and(|extension| extension == "parquet")
        {
            found.push(path);
        }
    }
    found.sort();
    Ok(())
}

/// The bytes of a data set, or of one Parquet file of it, together with what its `meta` says; `None` for any other file. At most `limit`
/// bytes are read.
///
/// # Errors
/// A file that cannot be read; more bytes; a data set without Parquet files.
pub(super) fn bytes(path: &Path, limit: u64) -> Result<Option<Vec<u8>>> {
    let (root, files) = match (is_data_set(path), data_set_of(path)) {
        (true, _) => {
            let mut files = Vec::new();
            parquet_files(&path.join("data"), &mut files)?;
            (path, files)
        }
        (false, Some(root)) => (root, vec![path.to_path_buf()]),
        (false, None) => return Ok(None),
    };
    if files.is_empty() {
        return Err(Error::invalid("the data set holds no Parquet files")
            .at_file(path.join("data"))
            .allowed("the files that LeRobot has recorded: a copy from Hugging Face may hold only its description"));
    }
    let mut all = MAGIC.to_vec();
    let mut push = |content: Vec<u8>, file: &Path| {
        if (all.len() + content.len()) as u64 > limit {
            return Err(
                Error::invalid("the data set is too large to be read at once")
                    .at_file(file)
                    .allowed(format!("at most {limit} bytes"))
                    .hint("name single files of its folder `data`"),
            );
        }
        all.extend((content.len() as u64).to_le_bytes());
        all.extend(content);
        Ok(())
    };
    let info = root.join(INFO);
    push(
        read_limited(&info, limit, "description of the data set")?,
        &info,
    )?;
    let calibration = root.join(CALIBRATION);
    let content = match calibration.is_file() {
        true => read_limited(&calibration, limit, "calibration")?,
        false => Vec::new(),
    };
    push(content, &calibration)?;
    for file in files {
        push(read_limited(&file, limit, "trajectory")?, &file)?;
    }
    Ok(Some(all))
}

/// Reads one Parquet file but for the columns of which the function says so.
pub(super) type Table = dyn Fn(Vec<u8>, &dyn Fn(&str) -> bool) -> Result<String>;

/// The table of a data set whose bytes are those of [`bytes`]; `None` for other bytes. `table` reads one Parquet file, but
/// for some columns.
///
/// # Errors
/// A description or a calibration that is none; files with different columns; errors of `table`.
pub(super) fn decoded(bytes: &[u8], reading: &Reading, table: &Table) -> Result<Option<Decoded>> {
    let Some(mut rest) = bytes.strip_prefix(MAGIC) else {
        return Ok(None);
    };
    let mut parts = Vec::new();
    while let Some((size, after)) = rest.split_first_chunk::<8>() {
        let size = usize::try_from(u64::from_le_bytes(*size)).unwrap_or(usize::MAX);
        let (part, after) = after.split_at_checked(size).unwrap_or((after, &[]));
        parts.push(part);
        rest = after;
    }
    let [info, calibration, files @ ..] = parts.as_slice() else {
        return Err(Error::invalid("this is no data set of LeRobot"));
    };
    let broken = |file: &str, error: &dyn std::fmt::Display| {
        Error::invalid("a file of the data set is broken")
            .field(file)
            .found(error)
    };
    let info: Value = serde_json::from_slice(info).map_err(|e| broken(INFO, &e))?;
    let calibration = match calibration.is_empty() {
        true => None,
        false => Some(
            serde_json::from_slice::<Calibration>(calibration)
                .map_err(|e| broken(CALIBRATION, &e))?,
        ),
    };
    // Pictures within the table are no numbers.
    let is_picture = |column: &str| {
        let kind = feature(&info, column).and_then(|feature| feature.get("dtype"));
        matches!(kind.and_then(Value::as_str), Some("image" | "video"))
    };
    let mut tables = Vec::with_capacity(files.len());
    for file in files {
        tables.push(table(file.to_vec(), &is_picture)?);
    }
    joined(&tables, &info, calibration.as_ref(), reading).map(Some)
}

/// What becomes of a column.
enum Use {
    Left,
    Kept(String),
    /// A list of numbers, each with a name and how it is converted.
    List(Vec<(String, Option<Scale>)>),
}

fn joined(
    tables: &[String],
    info: &Value,
    calibration: Option<&Calibration>,
    reading: &Reading,
) -> Result<Decoded> {
    let header = tables.first().and_then(|table| table.lines().next());
    let header = header.unwrap_or_default();
    let names = split(header, ',');
    for table in tables {
        let own = table.lines().next().unwrap_or_default();
        if own != header {
            return Err(
                Error::invalid("the files of the data set have different columns")
                    .found(own)
                    .allowed(header),
            );
        }
    }
    let rows = || tables.iter().flat_map(|table| table.lines().skip(1));
    let state = names.iter().position(|name| *name == "observation.state");
    let scale = match (calibration, state) {
        (Some(calibration), Some(place)) => {
            let motors = motors(info, names[place]);
            let motors: Vec<&str> = motors.iter().map(|name| joint(name)).collect();
            let values = rows().take(20_000).map(|row| {
                let cell = split(row, ',').get(place).copied().unwrap_or_default();
                let numbers = numbers(cell);
                numbers
                    .iter()
                    .filter_map(|text| text.parse().ok())
                    .collect()
            });
            Some((calibration, calibration.kind(&motors, values)?))
        }
        _ => None,
    };
    let mut warnings = Vec::new();
    let mut uses = Vec::with_capacity(names.len());
    for name in &names {
        let motors = motors(info, name);
        let is_stated = reading.lists.contains_key(*name) || reading.names.contains_key(*name);
        let is_mapped = reading
            .columns
            .iter()
            .any(|(_, column)| column.name == *name);
        uses.push(match *name {
            name if is_stated || is_mapped => Use::Kept(name.to_owned()),
            name if COUNTERS.contains(&name) => Use::Left,
            // Seconds since the start of the episode.
            "timestamp" => Use::Kept("t_s".to_owned()),
            "episode_index" => Use::Kept("run".to_owned()),
            name if motors.is_empty() => Use::Kept(name.to_owned()),
            name => {
                let ending = match name {
                    "observation.state" => Some("_rad"),
                    "action" => Some("_command_rad"),
                    _ => None,
                };
                let names = motors.iter().map(|motor| match (scale, ending) {
                    (Some((calibration, kind)), Some(ending)) => {
                        let scale = calibration.scale(joint(motor), kind)?;
                        Ok((format!("{}{ending}", joint(motor)), Some(scale)))
                    }
                    _ => Ok((format!("{name}.{}", plain(motor)), None)),
                });
                Use::List(names.collect::<Result<_>>()?)
            }
        });
    }
    if let Some((_, kind)) = scale {
        warnings.push(Code::ReadAs.warning(format!(
            "joints are in {}, as the steps of the encoders in {CALIBRATION} show; angle 0 is the middle of each range",
            kind.words()
        )));
    }
    let text = |key: &str| info.get(key).and_then(Value::as_str).unwrap_or("unknown");
    warnings.push(Code::ReadAs.warning(format!(
        "a data set of LeRobot {} of the robot {}, {}: the names of joints are those in {INFO}",
        text("codebase_version"),
        text("robot_type"),
        counted(tables.len(), "file")
    )));
    let mut out = String::new();
    let mut push_row = |cells: Vec<String>| {
        out.push_str(&cells.join(","));
        out.push('\n');
    };
    push_row(uses.iter().flat_map(Use::names).collect());
    for (index, row) in rows().enumerate() {
        let cells = split(row, ',');
        let mut made = Vec::with_capacity(cells.len());
        for ((cell, own), name) in cells.iter().zip(&uses).zip(&names) {
            let wrong = || {
                Error::invalid("a list of the wrong length")
                    .at_line(index + 2, 1)
                    .field(*name)
                    .found(counted(numbers(cell).len(), "number"))
                    .allowed(format!("as many as {INFO} names"))
            };
            made.extend(own.cells(cell).ok_or_else(wrong)?);
        }
        push_row(made);
    }
    Ok(Decoded {
        text: out,
        warnings,
    })
}

impl Use {
    fn names(&self) -> Vec<String> {
        match self {
            Self::Left => Vec::new(),
            Self::Kept(name) => vec![name.clone()],
            Self::List(all) => all.iter().map(|(name, _)| name.clone()).collect(),
        }
    }

    /// The cells that a cell becomes; `None` for a list of another length.
    fn cells(&self, cell: &str) -> Option<Vec<String>> {
        Some(match self {
            Self::Left => Vec::new(),
            Self::Kept(_) => vec![cell.to_owned()],
            Self::List(all) => {
                let numbers = numbers(cell);
                if numbers.len() != all.len() {
                    return None;
                }
                let cells = numbers
                    .iter()
                    .zip(all)
                    .map(|(text, (_, scale))| match scale {
                        Some(scale) => text.parse().map_or_else(
                            |_| String::new(),
                            |value| scale.angle_rad(value).to_string(),
                        ),
                        None => (*text).to_owned(),
                    });
                cells.collect()
            }
        })
    }
}

/// What the description says about a column.
fn feature<'a>(info: &'a Value, column: &str) -> Option<&'a Value> {
    info.get("features").and_then(|all| all.get(column))
}

/// The names of the numbers in a column, in the order of the list: `names`, or the only list in it (`{"motors": [...]}`).
fn motors(info: &Value, column: &str) -> Vec<String> {
    let names = feature(info, column).and_then(|feature| feature.get("names"));
    let list = match names {
        Some(Value::Object(named)) => named.values().next(),
        other => other,
    };
    let list = list.and_then(Value::as_array);
    let all: Vec<String> = list
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .map(str::to_owned)
        .collect();
    match all.len() {
        // A single number is no list in the file.
        1 => Vec::new(),
        _ => all,
    }
}

/// The name of a joint without what LeRobot puts before and behind it.
fn joint(motor: &str) -> &str {
    let motor = motor.strip_suffix(".pos").unwrap_or(motor);
    motor.strip_prefix("main_").unwrap_or(motor)
}

/// The name without characters that separate cells.
fn plain(motor: &str) -> String {
    motor.replace([',', '"', '\n', '\r'], " ")
}
