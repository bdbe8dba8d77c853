//! Options that say how recordings are to be read.

use std::path::{Path, PathBuf};

use clap::Args;
use realgap::trajectory::{Axes, Columns, Crop, Only, QuaternionOrder, Reading, Ticks};
use realgap::unit::{AngleUnit, LengthUnit, TimeUnit};
use realgap::{Error, Result};

/// How recordings are read. These options override the study and the `meta.ron` beside the files (docs/recordings.md).
#[derive(Debug, Clone, Default, Args)]
pub struct ReadingOptions {
    /// File with the fields of a study's `reading`, which says how recordings are read (- for none)
    #[arg(long = "reading", value_name = "FILE", help_heading = READING)]
    reading_files: Vec<PathBuf>,
    /// Unit of length: m, cm, mm, in, ft, or px together with --scale; a unit in a column's name has priority
    #[arg(long, value_name = "UNIT", help_heading = READING)]
    unit: Vec<UnitOption>,
    /// Metres per unit of the file's lengths, e.g. 0.0021 per pixel, or as a known length over its size in the file: 0.5/238
    #[arg(long, value_name = "METRES", help_heading = READING)]
    scale: Vec<ScaleOption>,
    /// Unit of time: s, ms, us or ns
    #[arg(long, value_name = "UNIT", help_heading = READING)]
    time_unit: Vec<TimeUnit>,
    /// Unit of angle: rad or deg
    #[arg(long, value_name = "UNIT", help_heading = READING)]
    angle_unit: Vec<AngleUnit>,
    /// Counts per turn of the joints' encoders, in columns NAME_ticks, and the count at angle 0 [default: half a turn]
    #[arg(long, value_name = "PER_TURN[,ZERO]", help_heading = READING)]
    ticks: Vec<Ticks>,
    /// Column of a quantity, e.g. 't=%time in ns', 'x=pose.x in mm' or 'run=trial' (repeatable); quantities: t t_ns x y z qw qx qy qz
    /// heading vx vy vz wx wy wz condition run
    #[arg(long, value_name = "WHAT=NAME", help_heading = READING)]
    column: Vec<String>,
    /// Order of quaternions, as their columns stand: wxyz or xyzw
    #[arg(long, value_name = "ORDER", help_heading = READING)]
    quaternion: Vec<QuaternionOrder>,
    /// Use only this part, in seconds since the first sample, e.g. 2.5: or 0:20
    #[arg(long, value_name = "FROM:TO", help_heading = READING)]
    crop: Vec<Crop>,
    /// Use only the rows in which a column has this value, e.g. robot=3
    #[arg(long = "where", value_name = "COLUMN=VALUE", help_heading = READING)]
    whose: Vec<Only>,
    /// Sort samples by time, where a few of them are out of order
    #[arg(long, help_heading = READING)]
    sort_samples: bool,
    /// Read the runs or bodies of one file as separate recordings: where times start again, or rows alternate between places
    #[arg(long, help_heading = READING)]
    split: bool,
    /// Times are SECONDS.NANOSECONDS without leading zeros: 12.5 is 12 s and 5 ns
    #[arg(long, help_heading = READING)]
    unpadded_stamps: bool,
    /// Leave out samples in which a number is missing
    #[arg(long, help_heading = READING)]
    skip_lost: bool,
    /// Number of lines before the line with the names of the columns
    #[arg(long, value_name = "N", help_heading = READING)]
    skip_lines: Option<usize>,
    /// Names of the columns in their order, for files without a line of names, e.g. t_s,x_m,y_m; an empty name for what is not read
    #[arg(long, value_name = "NAME,NAME,...", help_heading = READING)]
    header: Vec<HeaderOption>,
    /// Samples per second, for files without times, or with a column that counts samples
    #[arg(long, value_name = "HZ", help_heading = READING)]
    rate_hz: Vec<f64>,
    /// The topic whose poses or joints are read (MCAP, bags of ROS 2), e.g. /odom
    #[arg(long, value_name = "NAME", help_heading = READING)]
    topic: Vec<String>,
    /// The topic of the commands that are joined to them by the clock, e.g. /cmd_vel
    #[arg(long, value_name = "NAME", help_heading = READING)]
    command_topic: Vec<String>,
    /// The frame whose transforms are read (MCAP, bags of ROS 2), e.g. base_link, or its pose in another one: 'base_link in map'
    #[arg(long, value_name = "NAME", help_heading = READING)]
    child_frame: Vec<String>,
    /// Which way the axes of poses point: world (z up), camera (x right, y down, z forward), y-up or z-down
    #[arg(long, value_name = "AXES", help_heading = READING)]
    axes: Vec<Axes>,
}

/// A unit of length, or pixels, whose size is given apart.
#[derive(Debug, Clone, Copy)]
struct UnitOption(Option<LengthUnit>);

impl std::str::FromStr for UnitOption {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text {
            "px" => Ok(Self(None)),
            text => match LengthUnit::by_word(text) {
                Some(unit) => Ok(Self(Some(unit))),
                None => text.parse().map(|unit| Self(Some(unit))),
            },
        }
    }
}

/// Metres per unit, as a number or as a fraction.
#[derive(Debug, Clone, Copy)]
struct ScaleOption(f64);

impl std::str::FromStr for ScaleOption {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let scale = match text.split_once('/') {
            Some((length, units)) => number(length).zip(number(units)).map(|(l, u)| l / u),
            None => number(text),
        };
        let scale = scale.filter(|scale| scale.is_finite() && *scale > 0.0);
        scale
            .map(Self)
            .ok_or_else(|| "allowed: metres per unit, e.g. 0.0021 or 0.5/238".to_owned())
    }
}

/// The names of columns, separated by commas.
#[derive(Debug, Clone)]
struct HeaderOption(Vec<String>);

impl std::str::FromStr for HeaderOption {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
        match names.len() > 1 {
            true => Ok(Self(names)),
            false => Err("allowed: the names of all columns, e.g. t_s,x_m,y_m".to_owned()),
        }
    }
}

const READING: &str = "How recordings are read (docs/recordings.md)";

/// The value for file `index` of `files`: the option is given once for all files, or once for each.
fn pick<T: Clone>(all: &[T], option: &str, index: usize, files: usize) -> Result<Option<T>> {
    match all.len() {
        0 => Ok(None),
        1 => Ok(Some(all[0].clone())),
        count if count == files => Ok(Some(all[index].clone())),
        count => Err(Error::usage("give this option once, or once per file")
            .field(option)
            .found(format!("{count} times"))
            .allowed(match files {
                1 => "once".to_owned(),
                files => format!("once, or {files} times: in the order of the files"),
            })),
    }
}

impl ReadingOptions {
    /// How all files are read.
    pub fn reading(&self) -> Result<Reading> {
        self.of_file(0, 1)
    }

    /// How the file `path` is read. A `--reading` that is given once for several files concerns those with its columns; any other file is read
    /// without it.
    pub fn of_path(&self, path: &Path, index: usize, files: usize) -> Result<Reading> {
        if files < 2 || self.reading_files.len() != 1 {
            return self.of_file(index, files);
        }
        let whole = self.of_file(index, files)?;
        match whole.fits(path)? {
            true => Ok(whole),
            false => Self {
                reading_files: Vec::new(),
                ..self.clone()
            }
            .of_file(index, files),
        }
    }

    /// How file `index` of `files` is read: an option that is given once is for all files, otherwise each is for one file.
    pub fn of_file(&self, index: usize, files: usize) -> Result<Reading> {
        let mut columns = Columns::default();
        for text in &self.column {
            columns = columns.with_text(text).map_err(Error::into_usage)?;
        }
        let unit = pick(&self.unit, "unit", index, files)?;
        let scale = pick(&self.scale, "scale", index, files)?;
        if matches!(unit, Some(UnitOption(None))) && scale.is_none() {
            return Err(Error::usage("the size of a pixel is not known")
                .field("unit")
                .found("px")
                .allowed("px together with --scale, the metres of one pixel")
                .hint(
                    "a known length over its pixels is a scale, too: --unit px --scale 0.5/238",
                ));
        }
        let own = Reading {
            columns,
            length: unit.and_then(|UnitOption(unit)| unit),
            scale: scale.map(|ScaleOption(scale)| scale),
            time: pick(&self.time_unit, "time_unit", index, files)?,
            angle: pick(&self.angle_unit, "angle_unit", index, files)?,
            ticks: pick(&self.ticks, "ticks", index, files)?,
            quaternion: pick(&self.quaternion, "quaternion", index, files)?,
            crop: pick(&self.crop, "crop", index, files)?,
            only: pick(&self.whose, "where", index, files)?,
            sort: self.sort_samples.then_some(true),
            split: self.split.then_some(true),
            unpadded_stamps: self.unpadded_stamps.then_some(true),
            skip_lost: self.skip_lost.then_some(true),
            skip_lines: self.skip_lines,
            header: pick(&self.header, "header", index, files)?
                .map_or_else(Vec::new, |HeaderOption(names)| names),
            rate_hz: pick(&self.rate_hz, "rate_hz", index, files)?,
            topic: pick(&self.topic, "topic", index, files)?,
            command_topic: pick(&self.command_topic, "command_topic", index, files)?,
            child_frame: pick(&self.child_frame, "child_frame", index, files)?,
            axes: pick(&self.axes, "axes", index, files)?,
            // The other fields can be set in a file only.
            ..Reading::default()
        };
        match pick(&self.reading_files, "reading", index, files)? {
            Some(path) if path.as_os_str() != "-" => Ok(own.or(&Reading::read(path)?)),
            _ => Ok(own),
        }
    }
}
