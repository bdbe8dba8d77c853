//! Finds and reads the columns of joints and signals by their names.
//!
//! `NAME_rad` is the angle of a joint and `NAME_rad_s` its speed, for any number of names (`_deg` and `_deg_s` likewise, and `NAME_ticks` for
//! the counts of an encoder, where the reading states them); commanded speeds,
//! torques, currents and duties, switches, and what other sensors measured ([`MeasuredQuantity`]) are signals ([`Signal`]).

use super::measured::MeasuredQuantity;
use super::reading::Ticks;
use super::{JointTrack, Signal};
use realgap_core::error::{Error, Result};
use realgap_core::text::fits;

/// The columns of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointColumns {
    /// Name of the joint.
    pub name: String,
    /// Column of the angle.
    pub angle: usize,
    /// Column of the same angle in degrees, beside one in radians: not read, but it must be the same.
    pub twin: Option<usize>,
    /// What is subtracted from the angle in radians: the angle of the encoder's zero.
    pub zero_rad: f64,
    /// Column of the speed.
    pub speed: Option<usize>,
}

/// Suffixes of an angle and of its speed, and the size of their unit in radians.
const ANGLES: [(&str, &str, f64); 2] = [
    ("_rad", "_rad_s", 1.0),
    ("_deg", "_deg_s", std::f64::consts::PI / 180.0),
];
/// Suffixes of the counts of an encoder, and of their speed.
const TICKS: (&str, &str) = ("_ticks", "_ticks_s");
/// Suffix after the name of a joint for its commanded angle.
pub const COMMAND: &str = "_command";
/// Suffixes of signals: commanded speeds, torques, currents and duties, and whether a servo is on.
pub const COMMAND_SIGNALS: [&str; 5] = [
    "_command_rad_s",
    "_command_nm",
    "_command_a",
    "_command_duty",
    "_on",
];
/// Endings of commanded speeds in other units, and the size of these in radians per second: such columns are read as
/// `NAME_command_rad_s`.
pub(super) const OTHER_SPEEDS: [(&str, f64); 2] = [
    ("_command_deg_s", std::f64::consts::PI / 180.0),
    ("_command_rpm", std::f64::consts::TAU / 60.0),
];
/// Endings of commands that state no unit: nobody can tell whether such a column holds angles, torques or currents.
pub const UNITLESS_COMMANDS: [&str; 6] = [
    COMMAND,
    "_command_position",
    "_command_velocity",
    "_command_speed",
    "_command_torque",
    "_command_current",
];
/// Names of angles that may belong to the whole body.
const ATTITUDE: [&str; 5] = ["heading", "yaw", "pitch", "roll", "theta"];

/// True if a column with this name may be the attitude of the whole body instead of a joint.
pub fn may_be_attitude(name: &str) -> bool {
    ATTITUDE.contains(&name)
}

/// A name as robots have it here: letters, digits, `_` and `-`. Files of other programs may have `left/hip` or `robot0:wrist`.
pub(super) fn plain_name(name: &str) -> String {
    let is_usual = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    name.chars()
        .map(|c| if is_usual(c) { c } else { '_' })
        .collect()
}

/// The same angle in radians and in whole degrees is not farther apart.
const MOST_APART_RAD: f64 = 0.01;
const MOST_APART: f64 = 0.01;

/// Finds the joints among the columns without a role; their columns are marked as used, and get the factors of their units.
pub(super) fn find(
    names: &[&str],
    used: &mut [bool],
    factors: &mut [f64],
    ticks: Option<Ticks>,
) -> Vec<JointColumns> {
    let mut joints = Vec::new();
    for angle in 0..names.len() {
        if used[angle] {
            continue;
        }
        let counted = ticks.map(|ticks| (TICKS.0, TICKS.1, ticks.size_rad()));
        let ending =
            ANGLES
                .iter()
                .chain(&counted)
                .find_map(|(angle_ending, speed_ending, unit)| {
                    let name = names[angle].strip_suffix(angle_ending)?;
                    (!name.is_empty()).then_some((name, speed_ending, *unit))
                });
        let Some((name, speed_ending, unit)) = ending else {
            continue;
        };
        // The same angle in both units: the one in radians is read, and the other is reported as not used.
        let in_radians = format!("{name}{}", ANGLES[0].0);
        if !names[angle].ends_with(ANGLES[0].0) && names.contains(&in_radians.as_str()) {
            continue;
        }
        let zero_rad = match ticks {
            Some(ticks) if names[angle].ends_with(TICKS.0) => unit * ticks.zero,
            _ => 0.0,
        };
        let speed_name = format!("{name}{speed_ending}");
        let speed = names.iter().position(|other| *other == speed_name);
        let speed = speed.filter(|index| !used[*index]);
        for index in std::iter::once(angle).chain(speed) {
            used[index] = true;
            factors[index] = unit;
        }
        let in_degrees = format!("{name}{}", ANGLES[1].0);
        let twin = names.iter().position(|other| *other == in_degrees);
        joints.push(JointColumns {
            name: name.to_owned(),
            twin: twin.filter(|twin| *twin != angle && !used[*twin]),
            angle,
            zero_rad,
            speed,
        });
    }
    joints
}

/// The joint of a commanded speed in another unit than radians per second, and the size of that unit.
fn other_speed(name: &str) -> Option<(&str, f64)> {
    let mut units = OTHER_SPEEDS.iter();
    units.find_map(|(ending, factor)| Some((name.strip_suffix(ending)?, *factor)))
}

/// Finds the signals among the columns without a role, with those that are kept without a unit, and marks their columns as used;
/// columns in other units get the factors of these.
pub(super) fn find_signals(
    names: &[&str],
    unitless: &[String],
    used: &mut [bool],
    factors: &mut [f64],
) -> Vec<usize> {
    // The same speed in two units: that in radians per second is read, and the other is reported as not used.
    let is_read_in_rad = |name: &str| {
        other_speed(name).is_some_and(|(joint, _)| {
            names.contains(&format!("{joint}{}", COMMAND_SIGNALS[0]).as_str())
        })
    };
    let is_command = |name: &str| {
        let is_other = other_speed(name).is_some() && !is_read_in_rad(name);
        is_other || COMMAND_SIGNALS.iter().any(|ending| name.ends_with(ending))
    };
    // A command without a unit beside the angle of its joint is kept, so that it can be refused.
    let has_no_unit = |name: &str| {
        let mut joints = UNITLESS_COMMANDS
            .iter()
            .filter_map(|end| name.strip_suffix(end));
        joints.any(|joint| {
            let of_joint = |ending: &str| names.contains(&format!("{joint}{ending}").as_str());
            ANGLES.iter().any(|(angle, ..)| of_joint(angle))
                && !ANGLES
                    .iter()
                    .any(|(angle, ..)| of_joint(&format!("{COMMAND}{angle}")))
                && !COMMAND_SIGNALS[..4].iter().any(|signal| of_joint(signal))
        })
    };
    let is_signal = |name: &str| {
        let is_kept = unitless.iter().any(|kept| fits(kept, name));
        let is_known = is_command(name) || MeasuredQuantity::of_column(name).is_some();
        is_kept || is_known || has_no_unit(name)
    };
    let found: Vec<usize> = (0..names.len())
        .filter(|index| !used[*index] && is_signal(names[*index]))
        .collect();
    for index in &found {
        used[*index] = true;
        if let Some((_, factor)) = other_speed(names[*index]) {
            factors[*index] = factor;
        }
    }
    found
}

/// Adds the values of one line to the joints and signals.
pub(super) fn push(
    (joints, signals): (&mut Vec<JointTrack>, &mut Vec<Signal>),
    (joint_columns, signal_columns): (&[JointColumns], &[usize]),
    names: &[String],
    number: impl Fn(usize) -> Result<f64>,
) -> Result<()> {
    if joints.is_empty() {
        joints.extend(joint_columns.iter().map(|column| JointTrack {
            name: column.name.clone(),
            angles_rad: Vec::new(),
            speeds_rad_s: column.speed.map(|_| Vec::new()),
        }));
    }
    if signals.is_empty() {
        signals.extend(signal_columns.iter().map(|column| Signal {
            name: match other_speed(&names[*column]) {
                Some((joint, _)) => format!("{joint}{}", COMMAND_SIGNALS[0]),
                None => names[*column].clone(),
            },
            values: Vec::new(),
        }));
    }
    for (joint, column) in joints.iter_mut().zip(joint_columns) {
        if let Some(twin) = column.twin {
            let (angle_rad, angle_deg) = (number(column.angle)?, number(twin)?);
            let apart_rad = (angle_rad - angle_deg.to_radians()).abs();
            if apart_rad > MOST_APART_RAD + MOST_APART * angle_rad.abs() {
                return Err(
                    Error::invalid("two columns state different angles of one joint")
                        .field(names[twin].clone())
                        .found(format!("{angle_deg} degrees beside {angle_rad} radians"))
                        .allowed("the same angle in both units, or one of the columns"),
                );
            }
        }
        joint
            .angles_rad
            .push(number(column.angle)? - column.zero_rad);
        if let (Some(speeds), Some(speed)) = (&mut joint.speeds_rad_s, column.speed) {
            speeds.push(number(speed)?);
        }
    }
    for (signal, column) in signals.iter_mut().zip(signal_columns) {
        let value = match MeasuredQuantity::of_column(&signal.name) {
            // A log may have rows without a value of this sensor; such a column is left out as a whole, later.
            Some(_) => number(*column).unwrap_or(f64::NAN),
            None => number(*column)?,
        };
        signal.values.push(value);
    }
    Ok(())
}
