//! The columns of a log, and which joint and quantity their names state.

use super::super::super::joint_column::{COMMAND_SIGNALS, OTHER_SPEEDS};
use super::super::super::reading::Reading;
use super::super::super::relabel::{numbers, split};
use super::super::super::table::header_line;
use super::super::super::text::{Separator, excerpt};

/// What a column of a joint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Quantity {
    Angle,
    Command,
    Speed,
    CommandedSpeed,
    CommandedTorque,
    CommandedCurrent,
    Torque,
}

/// Words in the names of columns of commands, of angles, of speeds and of torques.
const COMMANDS: [&str; 14] = [
    "command",
    "cmd",
    "goal",
    "target",
    "setpoint",
    "des",
    "desired",
    "action",
    "ref",
    "reference",
    "qdes",
    "qcmd",
    "qref",
    "qtarget",
];
const ANGLES: [&str; 12] = [
    "q", "qpos", "pos", "position", "angle", "state", "actual", "measured", "meas", "present",
    "joint", "feedback",
];
const SPEEDS: [&str; 8] = [
    "qd", "qvel", "dq", "vel", "velocity", "speed", "qdot", "omega",
];
const TORQUES: [&str; 4] = ["tau", "torque", "effort", "nm"];
/// Words of currents, and of loads, whose unit no name states.
const CURRENTS: [&str; 1] = ["current"];
const LOADS: [&str; 1] = ["load"];
/// Words that say nothing about the quantity.
const FILLING: [&str; 14] = [
    "field",
    "observation",
    "motor",
    "servo",
    "id",
    "dxl",
    "axis",
    "joint",
    "joints",
    "deg",
    "rad",
    "ticks",
    "raw",
    "counts",
];

/// Rows whose values are looked at.
const ROWS: usize = 5000;
/// A column of a log, or one element of a list in a column.
pub(super) struct Column<'a> {
    pub(super) name: &'a str,
    pub(super) element: Option<usize>,
    pub(super) values: Vec<f64>,
}

/// The unit of a speed that a column's name states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SpeedUnit {
    RadiansPerSecond,
    DegreesPerSecond,
    RevolutionsPerMinute,
}

/// A column that belongs to a joint: by the joint's name, or by its number.
pub(super) struct Found<'c, 'a> {
    pub(super) column: &'c Column<'a>,
    pub(super) quantity: Quantity,
    pub(super) speed_unit: Option<SpeedUnit>,
    pub(super) joint: Whose,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Whose {
    Named(usize),
    Numbered(usize),
}

impl SpeedUnit {
    /// The unit at these words of a name, and the words without it: `rad_s`, `deg/s`, `dps`, `rpm`.
    fn take(words: &[String]) -> (Vec<String>, Option<Self>) {
        let units: [(&[&str], Self); 5] = [
            (&["rad", "s"], Self::RadiansPerSecond),
            (&["rads", "s"], Self::RadiansPerSecond),
            (&["deg", "s"], Self::DegreesPerSecond),
            (&["dps"], Self::DegreesPerSecond),
            (&["rpm"], Self::RevolutionsPerMinute),
        ];
        for (unit, found) in units {
            let at = words.windows(unit.len()).position(|part| part == unit);
            if let Some(at) = at {
                let rest = [&words[..at], &words[at + unit.len()..]].concat();
                return (rest, Some(found));
            }
        }
        (words.to_vec(), None)
    }

    /// The ending of a column of a commanded speed in this unit, in files of this program.
    pub(super) fn command_ending(self) -> &'static str {
        match self {
            Self::RadiansPerSecond => COMMAND_SIGNALS[0],
            Self::DegreesPerSecond => OTHER_SPEEDS[0].0,
            Self::RevolutionsPerMinute => OTHER_SPEEDS[1].0,
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::RadiansPerSecond => "rad/s",
            Self::DegreesPerSecond => "deg/s",
            Self::RevolutionsPerMinute => "revolutions per minute",
        }
    }
}

impl Quantity {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Angle => "angles",
            Self::Command => "commanded angles",
            Self::Speed => "speeds",
            Self::CommandedSpeed => "commanded speeds",
            Self::CommandedTorque => "commanded torques",
            Self::CommandedCurrent => "commanded currents",
            Self::Torque => "measured torques",
        }
    }
}

impl Column<'_> {
    pub(super) fn label(&self) -> String {
        match self.element {
            Some(index) => format!("{}[{index}]", self.name),
            None => excerpt(self.name),
        }
    }
}

/// The columns of numbers below the header, and the elements of columns that hold lists, with the values of the first rows.
pub(super) fn columns<'a>(text: &'a str, known: &Reading) -> Vec<Column<'a>> {
    let mut lines = text.lines().enumerate();
    let Some((_, header)) = header_line(&mut lines, known) else {
        return Vec::new();
    };
    let separator = Separator::of_header(header);
    let names: Vec<&str> = split(header, separator.character())
        .into_iter()
        .map(|name| name.trim_matches('"'))
        .collect();
    let mut columns: Vec<Column<'_>> = Vec::new();
    let mut places: Vec<Vec<usize>> = vec![Vec::new(); names.len()];
    for (row, (_, line)) in lines
        .filter(|(_, line)| !line.trim().is_empty())
        .take(ROWS)
        .enumerate()
    {
        for (index, cell) in split(line, separator.character())
            .into_iter()
            .enumerate()
            .take(names.len())
        {
            let is_list = cell.contains('[') || (cell.starts_with('"') && cell.contains(','));
            let values: Vec<f64> = match is_list {
                true => numbers(cell)
                    .iter()
                    .filter_map(|text| text.parse().ok())
                    .collect(),
                false => separator
                    .number(cell.trim_matches('"'))
                    .into_iter()
                    .collect(),
            };
            if row == 0 {
                for element in 0..values.len() {
                    places[index].push(columns.len());
                    columns.push(Column {
                        name: names[index],
                        element: is_list.then_some(element),
                        values: Vec::new(),
                    });
                }
            }
            for (place, value) in places[index].iter().zip(values) {
                columns[*place].values.push(value);
            }
        }
    }
    columns
}

/// The words of a name, in lower case, without its digits.
pub(super) fn words(name: &str) -> Vec<String> {
    let lower = name.to_lowercase();
    let parts = lower.split(|c: char| !c.is_ascii_alphabetic());
    parts
        .filter(|part| !part.is_empty())
        .map(str::to_owned)
        .collect()
}

/// The only number in a name; `None` if there is none, or several.
pub(super) fn only_number(name: &str) -> Option<usize> {
    let mut parts = name
        .split(|c: char| !c.is_ascii_digit())
        .filter(|part| !part.is_empty());
    let first = parts.next()?.parse().ok()?;
    parts.next().is_none().then_some(first)
}

/// True for `A1` and `J1`, as makers of industrial arms call the axes.
fn is_axis(name: &str) -> bool {
    let rest = name.strip_prefix(['A', 'J']);
    rest.is_some_and(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit()))
}

/// What is left of a column's name without the name of a joint; the suffix `_joint` of the joint may be missing in the column.
fn without_joint(column: &str, joint: &str) -> Option<String> {
    let column = column.to_lowercase();
    let joint = joint.to_lowercase();
    let short = joint
        .strip_suffix("_joint")
        .or_else(|| joint.strip_prefix("joint_"));
    // What is left of `joint_1` is a number, which another program may count from 0.
    let is_name = |name: &&str| name.chars().any(char::is_alphabetic);
    [Some(joint.as_str()), short]
        .into_iter()
        .flatten()
        .filter(is_name)
        .find_map(|joint| {
            let at = column.find(joint)?;
            let is_end = |c: Option<char>| c.is_none_or(|c| !c.is_ascii_alphanumeric());
            let (before, after) = (&column[..at], &column[at + joint.len()..]);
            let is_whole = is_end(before.chars().next_back()) && is_end(after.chars().next());
            is_whole.then(|| format!("{before} {after}"))
        })
}

/// The quantity that these words of a column's name state, beside the unit of a speed; `None` for another quantity.
fn quantity(words: &[String], is_per_second: bool) -> Option<Quantity> {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_known = |word: &String| {
        let lists: [&[&str]; 7] = [
            &COMMANDS, &ANGLES, &SPEEDS, &TORQUES, &CURRENTS, &LOADS, &FILLING,
        ];
        lists.iter().any(|list| list.contains(&word.as_str()))
    };
    if !words.iter().all(is_known) {
        return None;
    }
    if has(&LOADS) {
        return None;
    }
    if has(&CURRENTS) {
        let is_command = has(&COMMANDS) && !has(&SPEEDS) && !has(&TORQUES);
        return is_command.then_some(Quantity::CommandedCurrent);
    }
    match (has(&COMMANDS), is_per_second || has(&SPEEDS), has(&TORQUES)) {
        (true, true, false) => Some(Quantity::CommandedSpeed),
        (true, false, true) => Some(Quantity::CommandedTorque),
        (true, false, false) => Some(Quantity::Command),
        (false, true, false) => Some(Quantity::Speed),
        (false, false, true) => Some(Quantity::Torque),
        (false, false, false) => Some(Quantity::Angle),
        _ => None,
    }
}

/// The joint and the quantity of a column.
pub(super) fn found<'c, 'a>(column: &'c Column<'a>, joints: &[String]) -> Option<Found<'c, 'a>> {
    let make = |joint: Whose, rest: &str| {
        let (words, speed_unit) = SpeedUnit::take(&words(rest));
        let quantity = quantity(&words, speed_unit.is_some())?;
        Some(Found {
            column,
            quantity,
            speed_unit,
            joint,
        })
    };
    if let Some(element) = column.element {
        return make(Whose::Numbered(element), column.name);
    }
    let mut named = joints.iter().enumerate().filter_map(|(index, joint)| {
        let rest = without_joint(column.name, joint)?;
        Some((joint.len(), index, rest))
    });
    let longest = named.by_ref().max_by_key(|(length, ..)| *length);
    if let Some((_, index, rest)) = longest {
        return make(Whose::Named(index), &rest);
    }
    // The only joint of a robot may have a log without its name: `goal position (deg)`, `position`.
    if let ([_], None) = (joints, only_number(column.name))
        && !words(column.name).is_empty()
    {
        return make(Whose::Named(0), column.name);
    }
    let number = only_number(column.name)?;
    if is_axis(column.name) {
        return make(Whose::Numbered(number), "axis");
    }
    // A bare number is no joint: the name has to say what it counts.
    (!words(column.name).is_empty()).then(|| make(Whose::Numbered(number), column.name))?
}
