//! Infers from the name of a column which quantity it holds, and whose.

use super::super::column::{Measure, Role};
use super::super::column_name::{StatedUnit, unit_of_word, words};

/// Words beside an axis that make the column a part of an orientation.
const ORIENTATION: [&str; 9] = [
    "q",
    "quat",
    "quaternion",
    "orientation",
    "orient",
    "ori",
    "rot",
    "rotation",
    "attitude",
];
/// Words beside an axis that say nothing about whose position or orientation it is.
const FILLERS: [&str; 28] = [
    "pose",
    "poses",
    "position",
    "pos",
    "point",
    "translation",
    "trans",
    "transform",
    "transforms",
    "field",
    "message",
    "msg",
    "coord",
    "coordinate",
    "coordinates",
    "location",
    "loc",
    "p",
    "t",
    "tf",
    "data",
    "state",
    "value",
    "world",
    "global",
    "xyz",
    "rpy",
    "angle",
];
/// Words that make the column neither a position nor an orientation nor a heading: velocities and other quantities, …
const OTHERS: [&str; 35] = [
    "v",
    "vel",
    "velocity",
    "twist",
    "linear",
    "angular",
    "lin",
    "ang",
    "speed",
    "rate",
    "acc",
    "accel",
    "acceleration",
    "omega",
    "gyro",
    "gyr",
    "euler",
    "mag",
    "force",
    "torque",
    "w",
    "bias",
    "std",
    "stddev",
    "sigma",
    "cov",
    "covariance",
    "var",
    "variance",
    "error",
    "err",
    "offset",
    "size",
    "scale",
    "wrench",
];
/// … and what is commanded instead of measured.
const COMMANDS: [&str; 14] = [
    "goal",
    "target",
    "cmd",
    "command",
    "commanded",
    "des",
    "desired",
    "ref",
    "reference",
    "setpoint",
    "sp",
    "waypoint",
    "planned",
    "plan",
];
/// Words that name a time.
const TIMES: [&str; 12] = [
    "t",
    "time",
    "times",
    "timestamp",
    "timestamps",
    "stamp",
    "stamps",
    "elapsed",
    "epoch",
    "datetime",
    "ts",
    "clock",
];
/// Words with which a time is a duration, not a stamp.
const DURATIONS: [&str; 15] = [
    "delta",
    "dt",
    "exec",
    "execution",
    "compute",
    "computation",
    "duration",
    "lap",
    "loop",
    "cpu",
    "step",
    "diff",
    "processing",
    "latency",
    "delay",
];
/// Words that name a heading.
const HEADINGS: [&str; 4] = ["yaw", "heading", "theta", "psi"];
/// Words that name a repeat.
const RUNS: [&str; 4] = ["run", "trial", "repeat", "take"];

/// The quantity in a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Named<'a> {
    pub(super) name: &'a str,
    pub(super) role: Role,
    pub(super) unit: Option<StatedUnit>,
    /// The words that say whose quantity it is: `odom` in `/odom/pose/position/x`.
    pub(super) whose: String,
    /// How unlikely a time is the stamp of the samples: 0 for `header.stamp`, 1 for `time`, 2 for times with further words.
    pub(super) rank: usize,
}

/// The quantity that the name of a column suggests.
pub(super) fn named(name: &str) -> Option<Named<'_>> {
    let all = words(name);
    let with_unit = all.split_last().and_then(|(unit, rest)| {
        let (role, whose, rank) = if rest.is_empty() {
            // A name that is nothing but a unit of time, as `sec` beside `nanosec`.
            unit_of_word(unit, Measure::Time).filter(|_| unit.len() > 1)?;
            (Role::Time, String::new(), 1)
        } else {
            role(rest).or_else(|| stamp_in_parts(rest, unit))?
        };
        let unit = unit_of_word(unit, role.measure())?;
        Some((role, whose, rank, Some(unit)))
    });
    let found =
        with_unit.or_else(|| role(&all).map(|(role, whose, rank)| (role, whose, rank, None)));
    let (role, whose, rank, unit) = found?;
    Some(Named {
        name,
        role,
        unit,
        whose,
        rank,
    })
}

/// `tv_sec` beside `tv_usec`.
fn stamp_in_parts(rest: &[String], unit: &str) -> Option<(Role, String, usize)> {
    let is_time = rest == ["tv"] && unit_of_word(unit, Measure::Time).is_some();
    is_time.then(|| (Role::Time, String::new(), 1))
}

fn is_any(word: &str, kinds: &[&str]) -> bool {
    kinds.contains(&word)
}

/// The role that the words of a name suggest, whose quantity it is, and the rank of a time.
fn role(words: &[String]) -> Option<(Role, String, usize)> {
    let last = words.last()?.as_str();
    if (words.len() == 1 && is_any(last, &RUNS)) || words == ["episode", "index"] {
        return Some((Role::Run, String::new(), 0));
    }
    let has = |kinds: &[&str]| words.iter().any(|word| is_any(word, kinds));
    let whose = |besides: &dyn Fn(&str) -> bool| {
        let rest = words.iter().map(String::as_str);
        let rest = rest.filter(|word| !is_any(word, &FILLERS) && !besides(word));
        rest.collect::<Vec<_>>().join(".")
    };
    let is_excluded = has(&OTHERS) || has(&COMMANDS);
    let axes: Vec<(Role, &str)> = (words.iter())
        .filter_map(|word| Some((axis(word, has(&ORIENTATION))?, word.as_str())))
        .collect();
    if let [(role, word)] = axes.as_slice() {
        // `w.x` is an angular velocity, but `q.w` is a part of an orientation.
        let is_turn = matches!(role, Role::Qw | Role::Qx | Role::Qy | Role::Qz);
        let others = words.iter().filter(|other| other != word);
        let is_other = others
            .clone()
            .any(|word| is_any(word, &OTHERS) && !(is_turn && word == "w"));
        let is_command = others.clone().any(|word| is_any(word, &COMMANDS));
        let whose = whose(&|other| other == *word || is_any(other, &ORIENTATION));
        return (!is_other && !is_command).then_some((*role, whose, 0));
    }
    if has(&HEADINGS) && axes.is_empty() && !is_excluded {
        let whose = whose(&|word| is_any(word, &HEADINGS) || is_any(word, &ORIENTATION));
        return Some((Role::Heading, whose, 0));
    }
    let is_time = is_any(last, &TIMES) || has(&["time", "timestamp", "stamp", "elapsed"]);
    if is_time && axes.is_empty() && !is_excluded && !has(&DURATIONS) {
        let whose = whose(&|word| is_any(word, &TIMES) || word == "header");
        let rank = match (has(&["header"]) && has(&["stamp"]), words.len()) {
            (true, _) => 0,
            (_, 1) => 1,
            _ => 2,
        };
        return Some((Role::Time, whose, rank));
    }
    None
}

/// The axis in a word: `x`, `tx`, `px`, `posx`, `qx`, `quatx`; `is_turn` says that other words of the name speak of an orientation.
fn axis(word: &str, is_turn: bool) -> Option<Role> {
    let turns = [
        ("w", Role::Qw),
        ("x", Role::Qx),
        ("y", Role::Qy),
        ("z", Role::Qz),
    ];
    for (letter, role) in turns {
        let fused = ["q", "quat", "quaternion"];
        let is_fused = fused
            .iter()
            .any(|start| word.strip_prefix(start) == Some(letter));
        if is_fused || (is_turn && word == letter) {
            return Some(role);
        }
    }
    if is_turn {
        return None;
    }
    let places = [("x", Role::X), ("y", Role::Y), ("z", Role::Z)];
    let found = places.iter().find(|(letter, _)| {
        let before = ["", "t", "p", "pos", "position", "loc", "coord"];
        let after = ["pos", "position", "coord"];
        before
            .iter()
            .any(|start| word.strip_prefix(start) == Some(letter))
            || after
                .iter()
                .any(|end| word.strip_suffix(end) == Some(letter))
    });
    found.map(|(_, role)| *role)
}

/// True if the names are those of a position on the globe.
pub(super) fn is_geographic(names: &[&str]) -> bool {
    let has = |kinds: &[&str]| {
        let mut all = names.iter().flat_map(|name| words(name));
        all.any(|word| is_any(&word, kinds))
    };
    has(&["lat", "latitude"]) && has(&["lon", "lng", "long", "longitude"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_of_a_name_say_what_it_holds_and_whose() {
        for (name, role, whose) in [
            ("x", Role::X, ""),
            ("X (m)", Role::X, ""),
            ("Position X", Role::X, ""),
            ("x_position [mm]", Role::X, ""),
            ("px", Role::X, ""),
            ("robot.px", Role::X, "robot"),
            ("field.pose.pose.position.x", Role::X, ""),
            ("/odom/pose/position/x", Role::X, "odom"),
            ("transforms[0].translation.y", Role::Y, "0"),
            ("tz", Role::Z, ""),
            ("posX", Role::X, ""),
            ("pose.pose.orientation.w", Role::Qw, ""),
            ("q_x", Role::Qx, ""),
            ("quat_w", Role::Qw, ""),
            ("qz", Role::Qz, ""),
            ("theta", Role::Heading, ""),
            ("odom_yaw_deg", Role::Heading, "odom"),
            ("timestamp", Role::Time, ""),
            ("time_boot_ms", Role::Time, "boot"),
            ("TimeUS", Role::Time, ""),
            ("%time", Role::Time, ""),
            ("field.header.stamp", Role::Time, ""),
            ("header.stamp.nanosec", Role::Time, ""),
            ("tv_usec", Role::Time, ""),
            ("Time (s)", Role::Time, ""),
            ("elapsed", Role::Time, ""),
            ("sec", Role::Time, ""),
            ("t_ms", Role::Time, ""),
            ("trial", Role::Run, ""),
            ("episode_index", Role::Run, ""),
        ] {
            let found = named(name);
            let found = found
                .as_ref()
                .map(|found| (found.role, found.whose.as_str()));
            assert_eq!(found, Some((role, whose)), "{name}");
        }
        for name in [
            "vx",
            "twist.twist.linear.x",
            "goal_x",
            "w.x",
            "accel x",
            "pose.covariance[0]",
            "speed",
            "yaw_rate",
            "cmd_yaw",
            "exec_time",
            "frame_id",
            "roll",
            "s",
            "m",
            "battery",
            "max_x_y",
        ] {
            assert_eq!(named(name), None, "{name}");
        }
    }
}
