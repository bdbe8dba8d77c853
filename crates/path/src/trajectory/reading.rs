//! The settings for reading recorded files: columns, units, order of quaternions, which part and which robot.
//!
//! There is one type for all sources of these settings: the field `reading` of a study, a file of its own, the `reading` of a `meta.ron`
//! beside the recordings, and the options of the command line.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::column::{Columns, Measure, Role};
use super::levelling;
use super::wheels::WheelCommands;
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, parse_ron};
use realgap_core::unit::{AngleUnit, LengthUnit, TimeUnit, counted};

realgap_core::string_enum! {
    /// Order of the four numbers of a quaternion, in the order of their columns.
    QuaternionOrder.name, "is no order of a quaternion";
    /// Real part first, as in realgap's own files and in most papers.
    Wxyz "wxyz";
    /// Real part last, as in ROS, TUM files and most motion capture.
    Xyzw "xyzw";
}

impl QuaternionOrder {
    /// The columns of w, x, y, z, from four columns in this order.
    pub(super) fn wxyz(self, [a, b, c, d]: [usize; 4]) -> [usize; 4] {
        match self {
            Self::Wxyz => [a, b, c, d],
            Self::Xyzw => [d, a, b, c],
        }
    }
}

/// A part of every recording, in seconds since its first sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "crop")]
pub struct Crop {
    /// Start of the part, seconds since the first sample.
    #[serde(default)]
    pub from_s: f64,
    /// End of the part, seconds since the first sample; the end of the recording if that comes first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
}

impl Crop {
    fn is_sound(self) -> bool {
        let to_s = self.to_s.unwrap_or(f64::INFINITY);
        self.from_s >= 0.0 && self.from_s.is_finite() && to_s > self.from_s
    }
}

impl std::str::FromStr for Crop {
    type Err = String;

    /// Parses `FROM:TO`; a missing number means the start or the end of the recording.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let allowed = "allowed: FROM:TO in seconds since the first sample, e.g. 2.5: or 0:20";
        let (from, to) = text.split_once(':').ok_or(allowed)?;
        let number = |part: &str| match part.trim() {
            "" => Ok(None),
            part => part
                .parse::<f64>()
                .map(Some)
                .map_err(|_| allowed.to_owned()),
        };
        let crop = Self {
            from_s: number(from)?.unwrap_or(0.0),
            to_s: number(to)?,
        };
        crop.is_sound().then_some(crop).ok_or(allowed.to_owned())
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_s {
            Some(to_s) => write!(f, "{} s to {to_s} s", self.from_s),
            None => write!(f, "{} s to the end", self.from_s),
        }
    }
}

/// What the counts of an encoder mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "ticks")]
pub struct Ticks {
    /// Counts per turn.
    pub per_turn: f64,
    /// The count at angle 0.
    #[serde(default)]
    pub zero: f64,
}

impl Ticks {
    /// The angle of one count, radians.
    pub(super) fn size_rad(self) -> f64 {
        std::f64::consts::TAU / self.per_turn
    }

    fn is_sound(self) -> bool {
        (1.0..=1e9).contains(&self.per_turn) && self.zero.abs() <= 1e9
    }
}

impl std::str::FromStr for Ticks {
    type Err = String;

    /// Parses `PER_TURN` or `PER_TURN,ZERO`; without a zero it is the middle of the turn, as encoders of servos have it.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let allowed = "allowed: PER_TURN or PER_TURN,ZERO, e.g. 4096 or 4096,2048";
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| allowed.to_owned());
        let ticks = match text.split_once(',') {
            Some((per_turn, zero)) => Self {
                per_turn: number(per_turn)?,
                zero: number(zero)?,
            },
            None => Self {
                per_turn: number(text)?,
                zero: number(text)? / 2.0,
            },
        };
        ticks.is_sound().then_some(ticks).ok_or(allowed.to_owned())
    }
}

impl fmt::Display for Ticks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} counts per turn, 0 at {}", self.per_turn, self.zero)
    }
}

/// The rows of one robot in a file that holds several.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "only")]
pub struct Only {
    /// The column that names the robot of each row.
    pub column: String,
    /// The value of this column for the robot that is read.
    pub value: String,
}

impl std::str::FromStr for Only {
    type Err = String;

    /// Parses `COLUMN=VALUE`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.split_once('=') {
            Some((column, value)) if !column.trim().is_empty() => Ok(Self {
                column: column.trim().to_owned(),
                value: value.trim().to_owned(),
            }),
            _ => Err("allowed: COLUMN=VALUE, e.g. robot=3".to_owned()),
        }
    }
}

/// How files of recordings are to be read. The default is realgap's own format: column names with units, metres, seconds, radians, the real
/// part of quaternions first, and the whole recording.
///
/// ```
/// use realgap_core::file::Source;
/// use realgap_path::trajectory::Reading;
///
/// let reading = Reading::parse(&Source::new("reading.ron", r#"(
///     columns: (t: "%time in ns", x: "pose.x in mm", y: "pose.y in mm", heading: "yaw in deg"),
///     crop: (from_s: 2.5),
///     only: (column: "robot", value: "3"),
/// )"#))?;
/// assert_eq!(
///     reading.to_string(),
///     "t from `%time in ns`, x from `pose.x in mm`, y from `pose.y in mm`, heading from `yaw in deg`; \
///      only rows with robot = 3; 2.5 s to the end"
/// );
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "reading")]
pub struct Reading {
    /// Which column holds which quantity, if its name differs from realgap's own.
    #[serde(skip_serializing_if = "Columns::is_empty")]
    pub columns: Columns,
    /// Columns to rename: `{"Elbow": "elbow_flex_rad"}`; the new name states the unit of the numbers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub names: BTreeMap<String, String>,
    /// Columns that hold lists of numbers, with one column name per number: `{"action": ["pan_command_rad", "lift_command_rad"]}`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub lists: BTreeMap<String, Vec<String>>,
    /// Commanded forward speed and turn rate, and the wheels whose commanded speeds follow from them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wheels: Option<WheelCommands>,
    /// Columns without a unit that are kept as they are, because they command joints (`throttle`) or switch them (`enabled`); `*` stands
    /// for any letters. A study adds those that its `commands` name, and with a simulator of its own those of its `channels`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unitless: Vec<String>,
    /// Unit of lengths (and of velocities, per second) whose columns do not state a unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<LengthUnit>,
    /// Metres per unit of the file's lengths, for columns that do not state a unit: for example metres per pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Unit of times whose columns do not state a unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeUnit>,
    /// Unit of angles (and of angular velocities, per second) whose columns do not state a unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<AngleUnit>,
    /// The counts of the joints' encoders, in columns NAME_ticks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ticks: Option<Ticks>,
    /// Order of quaternions in the order of their columns, independent of the names of these columns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<QuaternionOrder>,
    /// The part of every recording that is read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<Crop>,
    /// The robot whose rows are read, in files with rows of several robots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<Only>,
    /// True if samples are sorted by time, where a few of them are out of order; of several samples at one time, the first is kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sort: Option<bool>,
    /// True if a file in which times start again, or in which the rows of several bodies alternate, is read as several recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split: Option<bool>,
    /// True if times are written as SECONDS.NANOSECONDS without leading zeros of the nanoseconds: 12.5 is 12 s and 5 ns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unpadded_stamps: Option<bool>,
    /// True if rows with a missing number are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skip_lost: Option<bool>,
    /// Number of lines before the line that names the columns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skip_lines: Option<usize>,
    /// The names of the columns in their order, for files without a line of names; an empty name for a column that is not read. The file
    /// must not name its columns itself.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub header: Vec<String>,
    /// Sampling rate of files without times or with a column that counts samples, samples per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// The topic whose poses or joints are read, in files with messages of several topics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topic: Option<String>,
    /// The topic of the commands that are joined to these poses or joints by the clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_topic: Option<String>,
    /// The child frame whose transforms are read, in files with transforms of several frames; `base_link in map` reads the pose of one
    /// frame in any other that transforms connect with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub child_frame: Option<String>,
    /// Directions of the axes of poses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Axes>,
    /// Components of the floor's normal along the recorded x and y, divided by its z component; recordings are turned about their
    /// last position until the normal is z.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_leans: Option<(f64, f64)>,
}

impl From<LengthUnit> for Reading {
    fn from(length: LengthUnit) -> Self {
        Self {
            length: Some(length).filter(|unit| *unit != LengthUnit::default()),
            ..Self::default()
        }
    }
}

impl From<&Reading> for Reading {
    fn from(reading: &Reading) -> Self {
        reading.clone()
    }
}

impl Reading {
    /// Reads a RON file that holds only these settings.
    ///
    /// # Errors
    /// A file that cannot be read; the errors of [`Reading::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "reading")?)
    }

    /// Parses a RON text.
    ///
    /// # Errors
    /// A text that is not RON with these fields, unknown units, an empty part: with file, line and column.
    pub fn parse(source: &Source) -> Result<Self> {
        let reading: Self = parse_ron(source)?;
        match reading.fault() {
            Some((field, error)) => Err(source.at(field, error).field(field)),
            None => Ok(reading),
        }
    }

    /// The first invalid field with its error; `None` if all fields are valid.
    pub fn fault(&self) -> Option<(&'static str, Error)> {
        if let Some(crop) = self.crop.filter(|crop| !crop.is_sound()) {
            let error = Error::invalid("this part is empty");
            let error = error
                .found(crop)
                .allowed("from_s of 0 or more, to_s later than from_s");
            return Some(("crop", error));
        }
        if let Some((x, y)) = self
            .floor_leans
            .filter(|&leans| !levelling::is_sound(leans))
        {
            let error = Error::invalid("the floor leans too far");
            let error = error
                .found(format!("({x}, {y})"))
                .allowed("two numbers from -1 to 1; for other directions of the axes set `axes`");
            return Some(("floor_leans", error));
        }
        if let Some(ticks) = self.ticks.filter(|ticks| !ticks.is_sound()) {
            let error = Error::invalid("these are no counts of an encoder");
            let error = error.found(ticks).allowed("1 to 1e9 counts per turn");
            return Some(("ticks", error));
        }
        if let Some(error) = self.wheels.as_ref().and_then(WheelCommands::fault) {
            return Some(("wheels", error));
        }
        let is_scale = |scale: &f64| (1e-12..=1e12).contains(scale);
        if let Some(scale) = self.scale.filter(|scale| !is_scale(scale)) {
            let error = Error::invalid("the scale of lengths is out of range");
            let error = error.found(scale).allowed("1e-12 to 1e12 metres per unit");
            return Some(("scale", error));
        }
        let is_rate = |rate_hz: &f64| (1e-6..=1e9).contains(rate_hz);
        self.rate_hz
            .filter(|rate_hz| !is_rate(rate_hz))
            .map(|rate_hz| {
                let error = Error::invalid("the sampling rate is out of range");
                let error = error
                    .found(rate_hz)
                    .allowed("1e-6 to 1e9 samples per second");
                ("rate_hz", error)
            })
    }

    /// Has these columns read without a unit, too.
    pub fn read_without_unit(&mut self, names: impl IntoIterator<Item = String>) {
        for name in names {
            if !self.unitless.contains(&name) {
                self.unitless.push(name);
            }
        }
    }

    /// These settings, completed by those of `other` where these are not set.
    #[must_use]
    pub fn or(self, other: &Self) -> Self {
        Self {
            columns: self.columns.or(&other.columns),
            names: merged(self.names, &other.names),
            lists: merged(self.lists, &other.lists),
            wheels: self.wheels.or_else(|| other.wheels.clone()),
            unitless: match self.unitless.is_empty() {
                true => other.unitless.clone(),
                false => self.unitless,
            },
            length: self.length.or(other.length),
            scale: self.scale.or(other.scale),
            time: self.time.or(other.time),
            angle: self.angle.or(other.angle),
            ticks: self.ticks.or(other.ticks),
            quaternion: self.quaternion.or(other.quaternion),
            crop: self.crop.or(other.crop),
            only: self.only.or_else(|| other.only.clone()),
            sort: self.sort.or(other.sort),
            split: self.split.or(other.split),
            unpadded_stamps: self.unpadded_stamps.or(other.unpadded_stamps),
            skip_lost: self.skip_lost.or(other.skip_lost),
            skip_lines: self.skip_lines.or(other.skip_lines),
            header: match self.header.is_empty() {
                true => other.header.clone(),
                false => self.header,
            },
            rate_hz: self.rate_hz.or(other.rate_hz),
            topic: self.topic.or_else(|| other.topic.clone()),
            command_topic: self.command_topic.or_else(|| other.command_topic.clone()),
            child_frame: self.child_frame.or_else(|| other.child_frame.clone()),
            axes: self.axes.or(other.axes),
            floor_leans: self.floor_leans.or(other.floor_leans),
        }
    }

    /// True if lengths are in another unit than metres.
    pub fn scales_lengths(&self) -> bool {
        let column = self.columns.get(Role::X).and_then(|column| column.factor);
        column.unwrap_or(self.factor(Measure::Length)) != 1.0
    }

    /// True if all settings have their defaults.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Factor from the file's unit to SI, for columns that do not state a unit.
    pub(super) fn factor(&self, measure: Measure) -> f64 {
        let length = || {
            let unit_m = self.length.unwrap_or_default().metres();
            self.scale.unwrap_or(unit_m)
        };
        let angle = || self.angle.unwrap_or_default().radians();
        match measure {
            Measure::Time => self.time.unwrap_or_default().seconds(),
            Measure::Length | Measure::Velocity => length(),
            Measure::Angle | Measure::AngularVelocity => angle(),
            Measure::Number | Measure::Label => 1.0,
        }
    }

    /// The name of the column with a label.
    pub(super) fn label(&self, role: Role) -> &str {
        let column = self.columns.get(role);
        column.map_or(role.name(), |column| column.name.as_str())
    }
}

/// The entries of `own`, and those entries of `other` whose keys `own` does not have.
fn merged<T: Clone>(
    mut own: BTreeMap<String, T>,
    other: &BTreeMap<String, T>,
) -> BTreeMap<String, T> {
    for (name, value) in other {
        own.entry(name.clone()).or_insert_with(|| value.clone());
    }
    own
}

/// Renamed columns that are listed in words.
const MOST_NAMES: usize = 4;

/// Describes in words how a file is read; empty if all settings have their defaults.
impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<String> = Vec::new();
        if !self.columns.is_empty() {
            let columns = self.columns.iter();
            let columns = columns.map(|(role, column)| format!("{} from `{column}`", role.name()));
            parts.push(columns.collect::<Vec<_>>().join(", "));
        }
        if !self.header.is_empty() {
            parts.push(format!("columns named {}", self.header.join(", ")));
        }
        let names = self.names.iter().take(MOST_NAMES);
        parts.extend(names.map(|(theirs, ours)| format!("`{theirs}` as {ours}")));
        if self.names.len() > MOST_NAMES {
            parts.push(format!("{} more names", self.names.len() - MOST_NAMES));
        }
        if !self.unitless.is_empty() {
            parts.push(format!("{} without a unit", self.unitless.join(", ")));
        }
        if let Some(wheels) = &self.wheels {
            parts.push(format!(
                "speeds of {} from `{}` and `{}`",
                counted(wheels.wheels.len(), "wheel"),
                wheels.forward,
                wheels.turn
            ));
        }
        let lists = self.lists.iter();
        parts.extend(lists.map(|(column, ours)| format!("`{column}` as {}", ours.join(", "))));
        parts.extend(self.length.map(|unit| format!("lengths in {unit}")));
        parts.extend(
            self.scale
                .map(|scale| format!("lengths in units of {scale} m")),
        );
        parts.extend(self.time.map(|unit| format!("times in {unit}")));
        parts.extend(self.angle.map(|unit| format!("angles in {unit}")));
        parts.extend(self.ticks.map(|ticks| format!("encoders with {ticks}")));
        parts.extend(
            self.quaternion
                .map(|o| format!("quaternions as {}", o.name())),
        );
        if let Some(only) = &self.only {
            parts.push(format!("only rows with {} = {}", only.column, only.value));
        }
        if self.sort == Some(true) {
            parts.push("sorted by time".to_owned());
        }
        if self.split == Some(true) {
            parts.push("runs or bodies split".to_owned());
        }
        if self.unpadded_stamps == Some(true) {
            parts.push("times as SECONDS.NANOSECONDS without leading zeros".to_owned());
        }
        if self.skip_lost == Some(true) {
            parts.push("without lost samples".to_owned());
        }
        parts.extend(
            self.rate_hz
                .map(|rate| format!("{rate} samples per second")),
        );
        parts.extend(self.topic.iter().map(|topic| format!("topic {topic}")));
        let commands = self.command_topic.iter();
        parts.extend(commands.map(|topic| format!("commands of {topic}")));
        let frame = self.child_frame.iter();
        parts.extend(frame.map(|frame| format!("transforms of {frame}")));
        parts.extend(self.axes.map(|axes| axes.to_string()));
        let leans = self.floor_leans;
        parts.extend(leans.map(|(x, y)| format!("a floor that leans by ({x}, {y})")));
        parts.extend(self.crop.map(|crop| crop.to_string()));
        f.write_str(&parts.join("; "))
    }
}
