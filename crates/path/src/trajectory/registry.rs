//! The registry of file formats: reads and writes trajectories, with the format chosen by the file extension.
//!
//! A new format is one new file that implements [`Format`] and one line in [`FORMATS`]; the
//! contract test in tests/formats.rs checks all formats.

use std::path::Path;

use super::body_column;
use super::column::{Columns, Role};
use super::crop::cropped;
use super::csv::Csv;
use super::euroc::Euroc;
use super::foreign::{
    DEEPLABCUT, ECHO_CSV, FRANKA, GROUPED, JOINT_ROWS, JSON_LINES, MOTIVE, NAMED_FIELDS,
    NORTH_EAST_DOWN, NPY, NPZ, OPENSIM, PLOTJUGGLER, PX4_CSV, QUALISYS, TEXT_TABLE, TOPIC_ECHO,
    TRC, VICON,
};
use super::format::{Format, Parsed};
use super::kitti::Kitti;
use super::known_kind::known_kind;
use super::lerobot::is_data_set;
use super::levelling;
use super::log::{Mcap, Rosbag, Ulog};
use super::meta::read_meta_beside;
use super::parquet::PARQUET;
use super::text::{MAX_FILE_BYTES, check_size};
use super::tum::Tum;
use super::{Meta, Reading, Recording, Trajectory, plausibility};
use realgap_core::error::{Error, Result};
use realgap_core::file::{read_limited, unknown_name};
use realgap_core::warning::{Code, Warning};

/// Columns that distinguish several recordings in one file, from the outermost to the innermost group.
pub const GROUP_COLUMNS: [&str; 2] = ["condition", "run"];

/// Every known format.
pub const FORMATS: &[&dyn Format] = &[
    &Csv,
    &Tum,
    &Euroc,
    &Kitti,
    &Mcap,
    &Rosbag,
    &Ulog,
    &PARQUET,
    &MOTIVE,
    &VICON,
    &DEEPLABCUT,
    &PLOTJUGGLER,
    &QUALISYS,
    &JOINT_ROWS,
    &NAMED_FIELDS,
    &GROUPED,
    &PX4_CSV,
    &TOPIC_ECHO,
    &ECHO_CSV,
    &JSON_LINES,
    &NPY,
    &NPZ,
    &NORTH_EAST_DOWN,
    &FRANKA,
    &OPENSIM,
    &TRC,
    &TEXT_TABLE,
];

fn extension_of(path: &Path) -> Option<String> {
    let extension = path.extension()?;
    Some(extension.to_string_lossy().to_ascii_lowercase())
}

/// The format of a file: among the formats with its extension, the one that recognises the bytes, else the first.
pub(super) fn format_in(path: &Path, bytes: &[u8]) -> Result<&'static dyn Format> {
    let named = format_of(path)?;
    let extension = extension_of(path).unwrap_or_default();
    let mut all = FORMATS.iter().copied();
    let own = all.find(|f| f.extensions().contains(&extension.as_str()) && f.recognises(bytes));
    Ok(own.unwrap_or(named))
}

/// The format for the extension of `path`, or of the data set in this folder; the first one if several formats have this extension.
///
/// # Errors
/// An unknown extension, or none.
pub fn format_of(path: &Path) -> Result<&'static dyn Format> {
    if is_data_set(path) {
        return Ok(&PARQUET);
    }
    let extension = extension_of(path);
    let wanted = extension.as_deref().unwrap_or_default();
    FORMATS
        .iter()
        .copied()
        .find(|format| format.extensions().contains(&wanted))
        .ok_or_else(|| {
            if let Some((what, remedy)) = known_kind(wanted) {
                return Error::invalid("this kind of file is not read")
                    .at_file(path)
                    .found(what)
                    .hint(remedy);
            }
            let mut known: Vec<String> = Vec::new();
            for extension in FORMATS.iter().flat_map(|format| format.extensions()) {
                let extension = format!(".{extension}");
                if !known.contains(&extension) {
                    known.push(extension);
                }
            }
            let found = extension.as_ref();
            let found = found.map_or_else(|| "no extension".to_owned(), |e| format!(".{e}"));
            let known = known.iter().map(String::as_str);
            unknown_name("kind of trajectory file", &found, known).at_file(path)
        })
}

/// Reads one recording; the extension chooses the format, and a `meta.ron` beside the file is attached.
///
/// The file is read with the settings of `reading` (a plain [`LengthUnit`](realgap_core::unit::LengthUnit) sets the unit of lengths), completed
/// by the `reading` in `meta.ron`; the result is in SI units.
///
/// # Errors
/// Unreadable file, unknown extension, more than [`MAX_FILE_BYTES`], anything that is not a
/// trajectory (with file, line and column), or a broken `meta.ron`.
pub fn read(path: impl AsRef<Path>, reading: impl Into<Reading>) -> Result<Recording> {
    let path = path.as_ref();
    File::new(path, named_bytes(path)?, reading)?.single()
}

/// Reads every recording in a CSV file with grouping columns, e.g. `condition,run,sample,t_s,x_m,y_m`.
///
/// One recording per combination of the values of `group_columns`, in order of first appearance, named
/// `<file stem>/<value>/<value>...`.
///
/// # Errors
/// The errors of [`read`]; a missing grouping column; a format that holds one recording only.
pub fn read_groups(
    path: impl AsRef<Path>,
    reading: impl Into<Reading>,
    group_columns: &[&str],
) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    File::new(path, named_bytes(path)?, reading)?.groups(group_columns)
}

/// Reads all recordings in a file: its groups if it has a column `run`, else one recording.
///
/// # Errors
/// The errors of [`read`].
pub fn read_all(path: impl AsRef<Path>, reading: impl Into<Reading>) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    parse_all(path, named_bytes(path)?, reading)
}

/// The bytes of a trajectory file, for [`parse_all`] and for hashing, so that the hashed bytes are the parsed bytes.
///
/// # Errors
/// A missing or unreadable file, or a folder. At most one byte more than [`MAX_FILE_BYTES`] is read; `parse_all`
/// refuses such a file.
pub fn read_bytes(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    match format_of(path) {
        Ok(format) => format.bytes(path, MAX_FILE_BYTES),
        Err(_) => read_limited(path, MAX_FILE_BYTES, "trajectory"),
    }
}

/// The bytes of a file whose extension names its format. An unknown extension is reported only if the file exists.
fn named_bytes(path: &Path) -> Result<Vec<u8>> {
    match format_of(path) {
        Err(unknown) if path.exists() => Err(unknown),
        _ => read_bytes(path),
    }
}

/// As [`read_all`], for a file whose bytes are already in memory; `path` names the file and says where its `meta.ron` is.
///
/// # Errors
/// The errors of [`read_all`].
pub fn parse_all(
    path: impl AsRef<Path>,
    bytes: Vec<u8>,
    reading: impl Into<Reading>,
) -> Result<Vec<Recording>> {
    let path = path.as_ref();
    let file = File::new(path, bytes, reading)?;
    let columns = file.columns();
    let [_, run] = file.group_columns();
    if columns.contains(&run) {
        let mut group_columns = file.group_columns().to_vec();
        group_columns.retain(|name| columns.contains(name));
        return file.groups(&group_columns);
    }
    file.all()
}

/// Reads all recordings in a file as repeats in named sets. Recordings with one value of the column `set_column` form a set, in which the
/// column `run` distinguishes the repeats. If `set_column` is `None`, the column `condition` is used, if the file has it and `run`;
/// otherwise all recordings form one set without a name.
///
/// # Errors
/// The errors of [`read_all`]; a column that the file does not have, or that is `run` itself.
pub fn read_sets(
    path: impl AsRef<Path>,
    reading: impl Into<Reading>,
    set_column: Option<&str>,
) -> Result<Vec<(String, Recording)>> {
    let path = path.as_ref();
    let file = File::new(path, named_bytes(path)?, reading)?;
    let [outer, run] = file.group_columns();
    let columns = file.columns();
    let has = |name: &str| columns.contains(&name);
    let set_column = match set_column {
        Some(column) if column == run => {
            return Err(Error::usage(
                "the column `run` already distinguishes the repeats of one set",
            )
            .field("group")
            .allowed("a column whose values are shared by several runs, e.g. condition"));
        }
        Some(column) => {
            for needed in [column, run] {
                if !has(needed) {
                    return Err(unknown_name("column to group the runs by", needed, columns.iter().copied())
                        .at_file(path)
                        .field("group")
                        .or_hint("grouped recordings have rows such as condition,run,t_s,x_m,y_m: one column names the set, `run` names the repeat"));
                }
            }
            Some(column)
        }
        None => Some(outer).filter(|outer| has(outer) && has(run)),
    };
    let Some(column) = set_column else {
        let all = if has(run) {
            file.groups(&[run])?
        } else {
            file.all()?
        };
        return Ok(all.into_iter().map(|r| (String::new(), r)).collect());
    };
    file.keyed(&[column, run])
}

impl Reading {
    /// True if the mapping of this reading fits a file: it has one of the columns, or there is no mapping. Files of formats without names of
    /// columns fit no mapping.
    ///
    /// # Errors
    /// A file that cannot be read at all.
    pub fn fits(&self, path: &Path) -> Result<bool> {
        let is_any = self.columns.is_empty() && self.names.is_empty() && self.lists.is_empty();
        if is_any {
            return Ok(true);
        }
        let bytes = named_bytes(path)?;
        let format = format_in(path, &bytes)?;
        let plain = Self {
            names: Default::default(),
            lists: Default::default(),
            ..self.clone()
        };
        let text = format
            .decode(bytes, &plain)
            .map_err(|error| error.at_file(path))?
            .text;
        let columns = format.columns(&text, &plain);
        let mapped = self.columns.iter().map(|(_, column)| column.name.as_str());
        let renamed = self.names.keys().map(String::as_str);
        // The lists of a data set are columns already, whose names begin with that of the list.
        let is_list = |name: &String| {
            let mut columns = columns.iter();
            columns.any(|column| {
                let rest = column.strip_prefix(name.as_str());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            })
        };
        Ok(mapped.chain(renamed).any(|name| columns.contains(&name))
            || self.lists.keys().any(is_list))
    }
}

/// The text of a file with the settings for reading it.
struct File<'a> {
    path: &'a Path,
    text: String,
    /// Warnings about how the text was taken from the file.
    decoding: Vec<Warning>,
    format: &'static dyn Format,
    reading: Reading,
    meta: Option<Meta>,
}

impl<'a> File<'a> {
    fn new(path: &'a Path, bytes: Vec<u8>, reading: impl Into<Reading>) -> Result<Self> {
        let format = format_in(path, &bytes)?;
        let meta = read_meta_beside(path)?;
        let mut reading: Reading = reading.into();
        if let Some(meta) = &meta {
            reading = reading.or(&meta.reading);
        }
        if let Some((field, error)) = reading.fault() {
            return Err(error.at_file(path).field(field));
        }
        if !reading.header.is_empty() && !format.takes_header() {
            return Err(Error::invalid("files of this format name their columns themselves")
                .at_file(path)
                .field("header")
                .found(format.doc())
                .hint("leave `header` out for this file, or rename the file if it is another kind: tables end with .csv"));
        }
        let decoded = check_size(&bytes).and_then(|()| format.decode(bytes, &reading));
        let decoded = decoded.map_err(|error| error.at_file(path))?;
        let text = decoded.text;
        Ok(Self {
            reading: format.applied(&text, &reading),
            path,
            text,
            decoding: decoded.warnings,
            format,
            meta,
        })
    }

    /// The error with its file. Below a stated line of names, the file has one line less than the text.
    fn located(&self, error: Error) -> Error {
        let error = error.at_file(self.path);
        match error.line_column() {
            Some((line, column)) if !self.reading.header.is_empty() => {
                error.at_line(line.saturating_sub(1).max(1), column)
            }
            _ => error,
        }
    }

    fn columns(&self) -> Vec<&str> {
        self.format.columns(&self.text, &self.reading)
    }

    /// The names of [`GROUP_COLUMNS`] in this file.
    fn group_columns(&self) -> [&str; 2] {
        [Role::Condition, Role::Run].map(|role| self.reading.label(role))
    }

    fn stem(&self) -> String {
        let stem = self.path.file_stem();
        stem.map(|stem| stem.to_string_lossy().into_owned())
            .unwrap_or_default()
    }

    /// The recordings of a file without a column that names them: one, or all runs and bodies if the reading splits them.
    fn all(&self) -> Result<Vec<Recording>> {
        let has_bodies = !body_column::names(&self.columns()).is_empty();
        if self.reading.split != Some(true) || has_bodies {
            return Ok(vec![self.single()?]);
        }
        let parts = self.format.parse_split(&self.text, &self.reading);
        let parts = parts.map_err(|error| self.located(error))?;
        let is_one = parts.len() == 1;
        let named = parts.into_iter().enumerate().map(|(index, parsed)| {
            let name = match is_one {
                true => self.stem(),
                false => format!("{}/{}", self.stem(), index + 1),
            };
            self.recording(name, parsed)
        });
        named.collect()
    }

    fn single(&self) -> Result<Recording> {
        if self.reading.split == Some(true) && body_column::names(&self.columns()).is_empty() {
            let mut all = self.all()?;
            return match (all.len(), all.pop()) {
                (1, Some(only)) => Ok(only),
                (count, _) => Err(Error::invalid(
                    "one recording is needed, and the file holds several",
                )
                .at_file(self.path)
                .found(format!("{count} runs or bodies"))
                .hint("write each of them into a file of its own")),
            };
        }
        let parse = |text: &str, reading: &Reading| {
            let parsed = self.format.parse(text, reading);
            parsed.map_err(|error| self.located(error))
        };
        let columns = self.columns();
        let mut names = body_column::names(&columns);
        if names.is_empty() {
            return self.recording(self.stem(), parse(&self.text, &self.reading)?);
        }
        if self.reading.floor_leans.is_some() {
            // Each body would be turned about its own last position, so the bodies would no longer fit together.
            return Err(
                Error::invalid("recordings of several bodies cannot be levelled")
                    .at_file(self.path)
                    .field("floor_leans")
                    .found(format!("columns of {}", names.join(", ")))
                    .allowed("recordings of one body"),
            );
        }
        // If only named bodies have columns, the first of them is the tracked body, unless a mapping says otherwise.
        let all = names.clone();
        let is_stated = !self.reading.columns.is_empty() || body_column::has_plain(&columns);
        let mut parsed = if is_stated {
            parse(&self.text, &self.reading)?
        } else {
            parse(
                &body_column::as_if_alone(&self.text, &names.remove(0)),
                &self.reading,
            )?
        };
        if body_column::all_belong(&columns, &all) {
            // The columns that the tracked body does not use belong to the other bodies.
            parsed.warnings.retain(|w| w.code != Code::ColumnsIgnored);
        }
        let plain = Reading {
            columns: Columns::default(),
            ..self.reading.clone()
        };
        let mut bodies = Vec::with_capacity(names.len());
        for name in names {
            let motion = parse(&body_column::as_if_alone(&self.text, &name), &plain)?.trajectory;
            let motion = self.to_world_frame(motion)?;
            let body = format!("{}, body {name}", self.stem());
            (parsed.warnings).extend(plausibility::path_warnings(&body, &motion, &self.reading));
            bodies.push((name, motion));
        }
        Ok(Recording {
            bodies,
            ..self.recording(self.stem(), parsed)?
        })
    }

    fn groups(&self, group_columns: &[&str]) -> Result<Vec<Recording>> {
        let keyed = self.keyed(group_columns)?;
        Ok(keyed.into_iter().map(|(_, recording)| recording).collect())
    }

    /// The groups of the file, each with its value of the outermost grouping column.
    fn keyed(&self, group_columns: &[&str]) -> Result<Vec<(String, Recording)>> {
        self.format
            .parse_groups(&self.text, &self.reading, group_columns)
            .map_err(|error| self.located(error))?
            .into_iter()
            .map(|(key, parsed)| {
                let name = format!("{}/{}", self.stem(), key.join("/"));
                let outer = key.into_iter().next().unwrap_or_default();
                Ok((outer, self.recording(name, parsed)?))
            })
            .collect()
    }

    /// Applies the settings that concern the motion: crops it, turns its axes to z up, and levels the floor.
    fn to_world_frame(&self, mut trajectory: Trajectory) -> Result<Trajectory> {
        if let Some(crop) = self.reading.crop {
            trajectory = cropped(&trajectory, crop).map_err(|e| e.at_file(self.path))?;
        }
        if let Some(axes) = self.reading.axes {
            trajectory = (axes.to_world(trajectory)).map_err(|e| e.at_file(self.path))?;
        }
        match self.reading.floor_leans {
            Some(leans) => {
                levelling::levelled(&trajectory, leans).map_err(|e| e.at_file(self.path))
            }
            None => Ok(trajectory),
        }
    }

    fn recording(&self, name: String, parsed: Parsed) -> Result<Recording> {
        let Parsed {
            trajectory,
            mut warnings,
        } = parsed;
        let trajectory = self.to_world_frame(trajectory)?;
        let mut used = self.reading.clone();
        if warnings.iter().any(|w| w.code == Code::UnitInName) {
            // The stated unit is not used, and this is said.
            (used.length, used.scale) = (None, None);
        }
        if !used.is_usual() {
            let how = format!("recordings are read with {used}");
            warnings.push(Code::ReadAs.warning(how));
        }
        let doubts = plausibility::warnings(
            &name,
            &trajectory,
            &self.reading,
            self.format.order(&self.text, &self.reading),
        );
        warnings.splice(0..0, self.decoding.iter().cloned());
        // A column that tells several robots apart says more than their motion.
        let is_told = warnings.iter().any(|w| w.code == Code::SeveralRobots);
        warnings.extend(
            doubts
                .into_iter()
                .filter(|w| !is_told || w.code != Code::SeveralRobots),
        );
        Ok(Recording {
            name,
            path: self.path.to_path_buf(),
            trajectory,
            log: None,
            bodies: Vec::new(),
            meta: self.meta.clone(),
            reading: self.reading.clone(),
            warnings,
        })
    }
}
