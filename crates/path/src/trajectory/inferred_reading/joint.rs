//! Infers which columns of another program's log hold the angles, commands and speeds of a robot's joints, and their unit.

use std::collections::BTreeMap;
use std::path::Path;

use super::super::csv::Csv;
use super::super::format::Format as _;
use super::super::reading::{Reading, Ticks};
use super::super::registry::{format_of, read_bytes};
use super::super::relabel::{numbers, split};
use super::super::table::header_line;
use super::super::text::{Separator, decode_text, excerpt};
use super::Evidence;
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{AngleUnit, counted};

/// A reading that names the columns of joints as this program does, with the evidence.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointReading {
    /// The given settings, completed by the names and the unit of the joints' columns.
    pub reading: Reading,
    /// The inferences, each with its reason.
    pub evidence: Vec<Evidence>,
}

/// What a column of a joint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Quantity {
    Angle,
    Command,
    Speed,
    CommandedSpeed,
    CommandedTorque,
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
const ANGLES: [&str; 11] = [
    "q", "pos", "position", "angle", "state", "actual", "measured", "meas", "present", "joint",
    "feedback",
];
const SPEEDS: [&str; 7] = ["qd", "dq", "vel", "velocity", "speed", "qdot", "omega"];
const TORQUES: [&str; 6] = ["tau", "torque", "effort", "nm", "current", "load"];
/// Words that say nothing about the quantity.
const FILLING: [&str; 9] = [
    "observation",
    "motor",
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
/// Angles beyond this are not in radians, those of joints that do not wind up.
const RADIANS: f64 = 7.0;
/// Angles beyond this are not in degrees.
const DEGREES: f64 = 361.0;
/// The largest counts of encoders per turn; whole numbers beyond the smallest of them are counts.
const PER_TURN: [f64; 4] = [1024.0, 4096.0, 16384.0, 65536.0];
/// The smallest count that is none of degrees.
const COUNTS: f64 = 400.0;
/// Differences below this are those of rounding.
const ROUNDED: f64 = 1e-4;
/// How near to a whole number of steps a move has to be, the share of moves that have to be so, and the smallest number of moves.
const WHOLE: f64 = 0.02;
const MOST_STEPS: f64 = 0.95;
const FEW: usize = 20;
/// The step of a common encoder of 4096 counts per turn, degrees.
const STEP_DEG: f64 = 360.0 / 4096.0;

/// A column of a log, or one element of a list in a column.
struct Column<'a> {
    name: &'a str,
    element: Option<usize>,
    values: Vec<f64>,
}

/// A column that belongs to a joint: by the joint's name, or by its number.
struct Found<'c, 'a> {
    column: &'c Column<'a>,
    quantity: Quantity,
    joint: Whose,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Whose {
    Named(usize),
    Numbered(usize),
}

impl JointReading {
    /// Infers the columns of the robot's `joints` in a log; `order` names the joints of numbered columns and of lists, in their order.
    /// `None` for a file that needs no inference, or that holds no columns of these joints.
    ///
    /// # Errors
    /// A file that cannot be read; numbered columns without an order; angles in a unit that the values do not show.
    pub fn infer(
        path: &Path,
        known: &Reading,
        joints: &[String],
        order: &[String],
    ) -> Result<Option<Self>> {
        let is_table = format_of(path)?.name() == Csv.name();
        if joints.is_empty() || !is_table || !known.names.is_empty() || !known.lists.is_empty() {
            return Ok(None);
        }
        let text = decode_text(read_bytes(path)?).map_err(|e| e.at_file(path))?;
        Self::of_text(&text, known, joints, order).map_err(|e| e.at_file(path))
    }

    fn of_text(
        text: &str,
        known: &Reading,
        joints: &[String],
        order: &[String],
    ) -> Result<Option<Self>> {
        let columns = columns(text, known);
        let own = |name: &str| {
            let mut joints = joints.iter();
            joints.any(|joint| {
                [format!("{joint}_rad"), format!("{joint}_deg")].contains(&name.to_owned())
            })
        };
        if columns.iter().any(|column| own(column.name)) {
            return Ok(None);
        }
        let found: Vec<Found<'_, '_>> = columns
            .iter()
            .filter_map(|column| found(column, joints))
            .collect();
        let has_angle = found.iter().any(|one| one.quantity == Quantity::Angle);
        if !has_angle {
            return Ok(None);
        }
        let order = order_of(&found, joints, order)?;
        let (unit, because) = unit(&found, known)?;
        let mut made = Self {
            reading: known.clone(),
            evidence: Vec::new(),
        };
        if let Unit::Ticks(ticks) = unit {
            made.reading.ticks = Some(ticks);
        }
        made.evidence.push(Evidence {
            finding: format!("angles of joints are in {}", unit.words()),
            reason: because,
        });
        let mut lists: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        let mut said: BTreeMap<Quantity, Vec<String>> = BTreeMap::new();
        for one in &found {
            let joint = match one.joint {
                Whose::Named(index) => &joints[index],
                Whose::Numbered(number) => match order.get(&number) {
                    Some(joint) => joint,
                    None => continue,
                },
            };
            let Some(name) = unit.name(joint, one.quantity) else {
                continue;
            };
            said.entry(one.quantity)
                .or_default()
                .push(format!("{joint} from `{}`", one.column.label()));
            match one.column.element {
                Some(_) => lists.entry(one.column.name).or_default().push(name),
                None => {
                    made.reading.names.insert(one.column.name.to_owned(), name);
                }
            }
        }
        for (column, names) in lists {
            made.reading.lists.insert(column.to_owned(), names);
        }
        for (quantity, all) in said {
            made.evidence.push(Evidence {
                finding: format!("{} of joints: {}", quantity.words(), all.join(", ")),
                reason: "the names of the columns".to_owned(),
            });
        }
        Ok(Some(made))
    }
}

impl Quantity {
    fn words(self) -> &'static str {
        match self {
            Self::Angle => "angles",
            Self::Command => "commanded angles",
            Self::Speed => "speeds",
            Self::CommandedSpeed => "commanded speeds",
            Self::CommandedTorque => "commanded torques",
        }
    }
}

impl Column<'_> {
    fn label(&self) -> String {
        match self.element {
            Some(index) => format!("{}[{index}]", self.name),
            None => excerpt(self.name),
        }
    }
}

/// The columns of numbers below the header, and the elements of columns that hold lists, with the values of the first rows.
fn columns<'a>(text: &'a str, known: &Reading) -> Vec<Column<'a>> {
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
fn words(name: &str) -> Vec<String> {
    let lower = name.to_lowercase();
    let parts = lower.split(|c: char| !c.is_ascii_alphabetic());
    parts
        .filter(|part| !part.is_empty())
        .map(str::to_owned)
        .collect()
}

/// The only number in a name; `None` if there is none, or several.
fn only_number(name: &str) -> Option<usize> {
    let mut parts = name
        .split(|c: char| !c.is_ascii_digit())
        .filter(|part| !part.is_empty());
    let first = parts.next()?.parse().ok()?;
    parts.next().is_none().then_some(first)
}

/// What is left of a column's name without the name of a joint; the suffix `_joint` of the joint may be missing in the column.
fn without_joint(column: &str, joint: &str) -> Option<String> {
    let column = column.to_lowercase();
    let joint = joint.to_lowercase();
    let short = joint
        .strip_suffix("_joint")
        .or_else(|| joint.strip_prefix("joint_"));
    [Some(joint.as_str()), short]
        .into_iter()
        .flatten()
        .find_map(|joint| {
            let at = column.find(joint)?;
            let is_end = |c: Option<char>| c.is_none_or(|c| !c.is_ascii_alphanumeric());
            let (before, after) = (&column[..at], &column[at + joint.len()..]);
            let is_whole = is_end(before.chars().next_back()) && is_end(after.chars().next());
            is_whole.then(|| format!("{before} {after}"))
        })
}

/// The quantity that these words of a column's name state; `None` for another quantity.
fn quantity(words: &[String]) -> Option<Quantity> {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_known = |word: &String| {
        let lists: [&[&str]; 5] = [&COMMANDS, &ANGLES, &SPEEDS, &TORQUES, &FILLING];
        lists.iter().any(|list| list.contains(&word.as_str()))
    };
    if !words.iter().all(is_known) {
        return None;
    }
    match (has(&COMMANDS), has(&SPEEDS), has(&TORQUES)) {
        (true, true, false) => Some(Quantity::CommandedSpeed),
        (true, false, true) => Some(Quantity::CommandedTorque),
        (true, false, false) => Some(Quantity::Command),
        (false, true, false) => Some(Quantity::Speed),
        (false, false, false) => Some(Quantity::Angle),
        _ => None,
    }
}

/// The joint and the quantity of a column.
fn found<'c, 'a>(column: &'c Column<'a>, joints: &[String]) -> Option<Found<'c, 'a>> {
    let make = |joint: Whose, rest: &str| {
        let quantity = quantity(&words(rest))?;
        Some(Found {
            column,
            quantity,
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
    let number = only_number(column.name)?;
    // A bare number is no joint: the name has to say what it counts.
    (!words(column.name).is_empty()).then(|| make(Whose::Numbered(number), column.name))?
}

/// The joint of every number.
fn order_of(
    found: &[Found<'_, '_>],
    joints: &[String],
    order: &[String],
) -> Result<BTreeMap<usize, String>> {
    let of = |quantity: Quantity| {
        let numbers = found.iter().filter(move |one| one.quantity == quantity);
        let numbers = numbers.filter_map(|one| match one.joint {
            Whose::Numbered(number) => Some(number),
            Whose::Named(_) => None,
        });
        let mut numbers: Vec<usize> = numbers.collect();
        numbers.sort_unstable();
        numbers
    };
    let numbers = of(Quantity::Angle);
    let Some(first) = numbers.first().copied() else {
        return Ok(BTreeMap::new());
    };
    let by_digits: BTreeMap<usize, String> = joints
        .iter()
        .filter_map(|joint| Some((only_number(joint)?, joint.clone())))
        .collect();
    if order.is_empty() && numbers.iter().all(|number| by_digits.contains_key(number)) {
        return Ok(by_digits);
    }
    let labels: Vec<String> = found
        .iter()
        .filter(|one| one.quantity == Quantity::Angle && matches!(one.joint, Whose::Numbered(_)))
        .map(|one| one.column.label())
        .collect();
    let is_one_joint = numbers.len() == 1 && joints.len() == 1;
    if order.len() != numbers.len() && !is_one_joint {
        return Err(Error::usage("the recordings leave a question open")
            .found(format!(
                "{} without names: {}",
                counted(numbers.len(), "joint"),
                labels.join(", ")
            ))
            .allowed(format!(
                "the names of these joints in this order, of {}",
                joints.join(", ")
            ))
            .advise(Advice::JointOrder));
    }
    if let Some(strange) = order.iter().find(|name| !joints.contains(name)) {
        return Err(Error::usage("the robot has no joint of this name")
            .found(strange)
            .allowed(joints.join(", "))
            .advise(Advice::JointOrder));
    }
    let names = if is_one_joint { joints } else { order };
    Ok(numbers
        .iter()
        .map(|number| (*number, names[number - first].clone()))
        .collect())
}

/// The unit of angles.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Unit {
    Of(AngleUnit),
    Ticks(Ticks),
}

impl Unit {
    fn words(self) -> String {
        match self {
            Self::Of(unit) => unit.to_string(),
            Self::Ticks(ticks) => format!("counts of an encoder ({ticks})"),
        }
    }

    /// The name of a column in this program's own files; `None` for a quantity that it does not read in this unit.
    fn name(self, joint: &str, quantity: Quantity) -> Option<String> {
        let symbol = match self {
            Self::Of(unit) => unit.symbol(),
            Self::Ticks(_) => "ticks",
        };
        let is_rad = self == Self::Of(AngleUnit::Radian);
        match quantity {
            Quantity::Angle => Some(format!("{joint}_{symbol}")),
            Quantity::Command => Some(format!("{joint}_command_{symbol}")),
            Quantity::Speed => Some(format!("{joint}_{symbol}_s")),
            Quantity::CommandedSpeed => is_rad.then(|| format!("{joint}_command_rad_s")),
            Quantity::CommandedTorque => Some(format!("{joint}_command_nm")),
        }
    }
}

/// The unit of the angles, with the reason: as stated, as the names say, or from the values.
fn unit(found: &[Found<'_, '_>], known: &Reading) -> Result<(Unit, String)> {
    if let Some(ticks) = known.ticks {
        return Ok((Unit::Ticks(ticks), "stated".to_owned()));
    }
    if let Some(unit) = known.angle {
        return Ok((Unit::Of(unit), "stated".to_owned()));
    }
    let is_angle =
        |one: &&Found<'_, '_>| matches!(one.quantity, Quantity::Angle | Quantity::Command);
    let angles: Vec<&Found<'_, '_>> = found.iter().filter(is_angle).collect();
    let says = |word: &str| {
        angles
            .iter()
            .all(|one| words(one.column.name).iter().any(|w| w == word))
    };
    for unit in [AngleUnit::Radian, AngleUnit::Degree] {
        if says(unit.symbol()) {
            return Ok((Unit::Of(unit), "the names of the columns say so".to_owned()));
        }
    }
    let values = || {
        angles
            .iter()
            .flat_map(|one| one.column.values.iter().copied())
    };
    let largest = values().fold(0.0, |most: f64, value| most.max(value.abs()));
    let are_whole = values().all(|value| value.fract() == 0.0);
    if are_whole && largest > COUNTS {
        let per_turn = PER_TURN.into_iter().find(|most| largest < *most);
        let per_turn = per_turn.unwrap_or(PER_TURN[3]);
        let ticks = Ticks {
            per_turn,
            zero: per_turn / 2.0,
        };
        let because = format!(
            "all are whole numbers up to {largest}; if the encoder has other counts, or its zero is elsewhere, state them as `ticks`"
        );
        return Ok((Unit::Ticks(ticks), because));
    }
    let reason = |unit: &str| format!("they reach {largest:.4}{unit}");
    if has_degree_steps(&angles) {
        let because =
            format!("their steps are those of 4096 counts per turn, {STEP_DEG:.4} degrees");
        return Ok((Unit::Of(AngleUnit::Degree), because));
    }
    if largest <= RADIANS {
        return Ok((Unit::Of(AngleUnit::Radian), reason("")));
    }
    let is_learning = angles.iter().any(|one| {
        let words = words(one.column.name);
        ["observation", "action"]
            .iter()
            .any(|known| words.iter().any(|word| word == known))
    });
    let is_full = values().any(|value| value.abs() == 100.0);
    if largest <= DEGREES && !(largest <= 100.0 && (is_learning || is_full)) {
        return Ok((Unit::Of(AngleUnit::Degree), reason("")));
    }
    let error = Error::usage("the recordings leave a question open").found(format!(
        "angles of joints up to {largest:.4}, and no name states their unit"
    ));
    Err(match largest <= 100.0 {
        true => error
            .allowed("degrees or radians; shares of a range from -100 to 100, as robot learning writes them, are no angles")
            .hint("turn shares into angles with the calibration of the robot")
            .advise(Advice::AngleUnit),
        false => error
            .allowed("degrees, radians, or counts of an encoder")
            .advise(Advice::AngleUnit),
    })
}

/// Whether measured angles move by steps of an encoder of 4096 counts per turn, in degrees; they may be rounded to few digits.
fn has_degree_steps(angles: &[&Found<'_, '_>]) -> bool {
    let measured = angles.iter().filter(|one| one.quantity == Quantity::Angle);
    let pairs = measured.flat_map(|one| one.column.values.windows(2));
    let moves = pairs.map(|pair| (pair[1] - pair[0]).abs());
    let counts: Vec<f64> = moves
        .filter(|by| *by > ROUNDED)
        .map(|by| by / STEP_DEG)
        .collect();
    let whole = counts
        .iter()
        .filter(|count| (*count - count.round()).abs() < WHOLE && count.round() > 0.0);
    counts.len() >= FEW && whole.count() as f64 > MOST_STEPS * counts.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINTS: [&str; 2] = ["pan", "lift"];

    /// A log of two joints, whose columns are called so; angles in units of `size` radians from `zero`.
    fn log(header: &str, row: &dyn Fn([f64; 4]) -> String) -> String {
        let rows = (0..50).map(|k| {
            let t = 0.02 * f64::from(k);
            let q = [
                (3.0 * t).sin(),
                0.5 * (2.0 * t).cos(),
                (3.1 * t).sin(),
                0.5 * (2.1 * t).cos(),
            ];
            format!("{t},{}\n", row(q))
        });
        format!("{header}\n{}", rows.collect::<String>())
    }

    fn infer(text: &str, known: &Reading, order: &[&str]) -> Result<Option<JointReading>> {
        let own = |names: &[&str]| {
            names
                .iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>()
        };
        JointReading::of_text(text, known, &own(&JOINTS), &own(order))
    }

    fn flat(scale: f64) -> impl Fn([f64; 4]) -> String {
        move |q| q.map(|q| format!("{:.6}", scale * q)).join(",")
    }

    #[test]
    fn names_of_other_programs_are_mapped_to_the_joints_with_their_quantity() {
        let degrees = 180.0 / std::f64::consts::PI;
        for (header, scale, expected) in [
            ("t,pan_pos,lift_pos,pan_cmd,lift_cmd", 1.0, "rad"),
            (
                "t,pan.pos,lift.pos,action.pan.pos,action.lift.pos",
                1.0,
                "rad",
            ),
            (
                "t,observation.state.pan,observation.state.lift,action.pan,action.lift",
                1.0,
                "rad",
            ),
            (
                "t,actual_pan,actual_lift,target_pan,target_lift",
                degrees,
                "deg",
            ),
            (
                "t,Pan_Position,Lift_Position,Pan_Goal_Position,Lift_Goal_Position",
                degrees,
                "deg",
            ),
            (
                "t,pan/position,lift/position,pan/setpoint,lift/setpoint",
                1.0,
                "rad",
            ),
        ] {
            let made = infer(&log(header, &flat(scale)), &Reading::default(), &[]).unwrap();
            let made = made.unwrap_or_else(|| panic!("{header}"));
            let names: Vec<&str> = header.split(',').skip(1).collect();
            let ours = ["pan_", "lift_", "pan_command_", "lift_command_"];
            for (theirs, ours) in names.iter().zip(ours) {
                let ours = format!("{ours}{expected}");
                assert_eq!(made.reading.names.get(*theirs), Some(&ours), "{header}");
            }
        }
    }

    #[test]
    fn numbered_joints_are_asked_about_and_lists_are_taken_apart_in_the_given_order() {
        let numbered = log("t,q1,q2,q_des1,q_des2", &flat(1.0));
        let error = infer(&numbered, &Reading::default(), &[])
            .unwrap_err()
            .to_string();
        assert!(error.contains("2 joints without names: q1, q2"), "{error}");
        let made = infer(&numbered, &Reading::default(), &["lift", "pan"])
            .unwrap()
            .unwrap();
        assert_eq!(made.reading.names["q1"], "lift_rad");
        assert_eq!(made.reading.names["q_des2"], "pan_command_rad");
        assert!(infer(&numbered, &Reading::default(), &["lift", "nose"]).is_err());
        let list = |q: [f64; 4]| format!("\"[{}, {}]\",\"[{}, {}]\"", q[0], q[1], q[2], q[3]);
        let lists = log("timestamp,observation.state,action", &list);
        let made = infer(&lists, &Reading::default(), &["pan", "lift"])
            .unwrap()
            .unwrap();
        assert_eq!(
            made.reading.lists["observation.state"],
            ["pan_rad", "lift_rad"]
        );
        assert_eq!(
            made.reading.lists["action"],
            ["pan_command_rad", "lift_command_rad"]
        );
    }

    #[test]
    fn counts_of_an_encoder_are_recognised_and_shares_of_a_range_are_asked_about() {
        let count = |q: [f64; 4]| {
            q.map(|q| format!("{:.0}", 2048.0 + q * 4096.0 / std::f64::consts::TAU))
                .join(",")
        };
        let counts = log(
            "t,pan_position,lift_position,pan_goal_position,lift_goal_position",
            &count,
        );
        let made = infer(&counts, &Reading::default(), &[]).unwrap().unwrap();
        assert_eq!(
            made.reading.ticks,
            Some(Ticks {
                per_turn: 4096.0,
                zero: 2048.0
            })
        );
        assert_eq!(made.reading.names["pan_position"], "pan_ticks");
        let header = "t,observation.pan.pos,observation.lift.pos,action.pan.pos,action.lift.pos";
        let shares = log(header, &flat(99.0));
        let error = infer(&shares, &Reading::default(), &[])
            .unwrap_err()
            .to_string();
        assert!(error.contains("-100 to 100"), "{error}");
        let degrees = Reading {
            angle: Some(AngleUnit::Degree),
            ..Reading::default()
        };
        let made = infer(&shares, &degrees, &[]).unwrap().unwrap();
        assert_eq!(made.reading.names["action.pan.pos"], "pan_command_deg");
    }

    #[test]
    fn a_log_in_own_names_and_a_table_without_joints_need_no_inference() {
        for header in [
            "t_s,pan_rad,lift_rad,pan_command_rad,lift_command_rad",
            "t_s,x_m,y_m,z_m,battery",
        ] {
            assert_eq!(
                infer(&log(header, &flat(1.0)), &Reading::default(), &[]).unwrap(),
                None
            );
        }
    }
}
