//! The path of a vehicle in a ULog as a table.

use std::collections::BTreeMap;

use super::walk::{Message, walk};
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::log::stream::{push_seconds, same_topic};
use crate::trajectory::text::{MAX_ROWS, excerpt, push_number};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::Code;

/// A topic that is read.
enum Kind {
    /// Position in the local frame: north, east, down.
    Position,
    /// Position and orientation.
    Odometry,
    Attitude,
    /// A list of what actuators are told.
    Actuators(&'static str),
}

const KINDS: [(&str, Kind); 13] = [
    ("vehicle_local_position", Kind::Position),
    ("vehicle_local_position_groundtruth", Kind::Position),
    ("vehicle_odometry", Kind::Odometry),
    ("vehicle_visual_odometry", Kind::Odometry),
    ("vehicle_mocap_odometry", Kind::Odometry),
    ("vehicle_attitude", Kind::Attitude),
    ("vehicle_attitude_groundtruth", Kind::Attitude),
    ("actuator_outputs", Kind::Actuators("output")),
    ("actuator_motors", Kind::Actuators("control")),
    ("actuator_servos", Kind::Actuators("control")),
    ("actuator_controls_0", Kind::Actuators("control")),
    ("actuator_controls_1", Kind::Actuators("control")),
    ("vehicle_vision_attitude", Kind::Attitude),
];
/// The frame of an odometry that is north, east, down; the other one has its x axis elsewhere, and z down, too.
const NED: f64 = 1.0;
/// Orientations and commands are taken from so long before or after a position, microseconds.
const NEAR_US: u64 = 200_000;
const LISTED: usize = 12;

fn kind(topic: &str) -> Option<&'static Kind> {
    let name = topic.split('/').next().unwrap_or_default();
    let found = KINDS.iter().find(|(known, _)| *known == name);
    found.map(|(_, kind)| kind)
}

/// One topic: its messages, or only their number.
#[derive(Default)]
struct Topic {
    count: usize,
    /// Times, microseconds, and values.
    rows: Vec<(u64, Vec<f64>)>,
}

/// The values of a message that are read: of a path its place, orientation and velocities (in the world, and turning in the body), z up,
/// NaN where there is none. A speed without turning cannot be used.
fn values(kind: &Kind, message: &Message<'_>) -> Vec<f64> {
    let value = |name: &str| message.layout.value(name, message.data).unwrap_or(f64::NAN);
    let list = |name: &str, count: usize| -> Vec<f64> {
        (0..count)
            .map(|index| value(&format!("{name}[{index}]")))
            .collect()
    };
    // North, east, down as north, west, up.
    let up = |v: [f64; 3]| [v[0], -v[1], -v[2]];
    let turn = |q: &[f64]| [q[0], q[1], -q[2], -q[3]];
    match kind {
        Kind::Position => {
            let is_valid = |name: &str| message.layout.value(name, message.data) != Some(0.0);
            let lost = |is_valid: bool, value: f64| if is_valid { value } else { f64::NAN };
            let (xy, z) = (is_valid("xy_valid"), is_valid("z_valid"));
            let place = up([
                lost(xy, value("x")),
                lost(xy, value("y")),
                lost(z, value("z")),
            ]);
            [place.as_slice(), &[f64::NAN; 10]].concat()
        }
        Kind::Odometry => {
            // The first versions had `x`, `y`, `z` and `vx`, `vy`, `vz`.
            let place = match message.layout.count("position") {
                0 => [value("x"), value("y"), value("z")],
                _ => [
                    value("position[0]"),
                    value("position[1]"),
                    value("position[2]"),
                ],
            };
            let speed = match value("velocity_frame") {
                NED => [
                    value("velocity[0]"),
                    value("velocity[1]"),
                    value("velocity[2]"),
                ],
                _ => [f64::NAN; 3],
            };
            let turning = [
                value("angular_velocity[0]"),
                value("angular_velocity[1]"),
                value("angular_velocity[2]"),
            ];
            let q = turn(&list("q", 4));
            [up(place).as_slice(), &q, &up(speed), &up(turning)].concat()
        }
        Kind::Attitude => turn(&list("q", 4)).to_vec(),
        Kind::Actuators(name) => list(name, message.layout.count(name)),
    }
}

impl Topic {
    /// The row nearest to a time.
    fn near(&self, time_us: u64) -> Option<&[f64]> {
        let next = self.rows.partition_point(|(own, _)| *own < time_us);
        let around = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let nearest = around
            .filter_map(|index| self.rows.get(index))
            .min_by_key(|(own, _)| own.abs_diff(time_us))?;
        (nearest.0.abs_diff(time_us) <= NEAR_US).then_some(nearest.1.as_slice())
    }

    /// The last row at or before a time.
    fn held(&self, time_us: u64) -> Option<&[f64]> {
        let next = self.rows.partition_point(|(own, _)| *own <= time_us);
        let (_, values) = self.rows.get(next.checked_sub(1)?)?;
        Some(values)
    }
}

/// The chosen path with what belongs to it.
pub(super) fn table(bytes: &[u8], reading: &Reading) -> Result<Decoded> {
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    let mut kept = 0;
    let end = walk(bytes, &mut |message| {
        let topic = match topics.get_mut(message.topic) {
            Some(topic) => topic,
            None => topics.entry(message.topic.to_owned()).or_default(),
        };
        topic.count += 1;
        if let Some(kind) = kind(message.topic) {
            let time_us = message.layout.time_us(message.data);
            let time_us = time_us
                .ok_or_else(|| Error::invalid("a message without a time").field(message.topic))?;
            topic.rows.push((time_us, values(kind, message)));
            kept += 1;
            if kept > MAX_ROWS {
                return Err(
                    Error::invalid("too many messages").allowed(format!("at most {MAX_ROWS}"))
                );
            }
        }
        Ok(())
    })?;
    for topic in topics.values_mut() {
        topic.rows.sort_by_key(|(time_us, _)| *time_us);
    }
    let is_path = |name: &str| matches!(kind(name), Some(Kind::Position | Kind::Odometry));
    let words = |(name, topic): (&String, &Topic)| {
        format!("{} ({})", excerpt(name), counted(topic.count, "message"))
    };
    let listed = |all: Vec<String>| {
        let more = all.len().saturating_sub(LISTED);
        let mut text = all[..all.len() - more].join("; ");
        if more > 0 {
            text.push_str(&format!("; {more} more"));
        }
        text
    };
    let is_wanted = |name: &str| match &reading.topic {
        Some(wanted) => same_topic(wanted, name),
        None => true,
    };
    let paths: Vec<(&String, &Topic)> = topics
        .iter()
        .filter(|(name, topic)| is_path(name) && is_wanted(name) && topic.count > 1)
        .collect();
    let (name, base) = match paths.as_slice() {
        [only] => *only,
        [] => {
            return Err(Error::invalid(match &reading.topic {
                Some(_) => "there are no positions with this name",
                None => "the log holds no positions",
            })
            .field("topic")
            .found(listed(topics.iter().map(words).collect()))
            .allowed("vehicle_local_position or vehicle_odometry")
            .advise(Advice::Topic));
        }
        several => {
            return Err(Error::invalid("the log holds several paths of the vehicle")
                .field("topic")
                .found(listed(several.iter().copied().map(words).collect()))
                .allowed("one of them")
                .advise(Advice::Topic));
        }
    };
    let mut warnings = vec![Code::ReadAs.warning(format!(
        "positions are those of {name}; its axes north, east, down are turned to x north, y west, z up"
    ))];
    if end.is_cut {
        warnings.push(Code::ReadAs.warning(
            "the log ends in the middle of a message: the vehicle lost its power, or the file is not whole",
        ));
    }
    if end.lost_ms > 0 {
        warnings.push(Code::ReadAs.warning(format!(
            "{} ms were not recorded, because the card was too slow",
            end.lost_ms
        )));
    }
    let attitude = topics.iter().find(|(own, topic)| {
        let is_of_truth = |name: &str| name.contains("groundtruth");
        let is_attitude = matches!(kind(own), Some(Kind::Attitude));
        is_attitude && is_of_truth(own) == is_of_truth(name) && topic.count > 1
    });
    let attitude = attitude.filter(|_| matches!(kind(name), Some(Kind::Position)));
    if let Some((own, _)) = attitude {
        warnings
            .push(Code::ReadAs.warning(format!("orientations are those of {own} nearest in time")));
    }
    let actuators: Vec<(&String, &Topic)> = topics
        .iter()
        .filter(|(own, topic)| matches!(kind(own), Some(Kind::Actuators(_))) && topic.count > 1)
        .collect();
    let rows: Vec<(u64, Vec<f64>)> = base
        .rows
        .iter()
        .map(|(time_us, own)| {
            let mut own = own.clone();
            if let Some((_, attitude)) = attitude {
                let turn = attitude.near(*time_us).unwrap_or(&[f64::NAN; 4]);
                own[3..7].copy_from_slice(turn);
            }
            (*time_us, own)
        })
        .collect();
    let names = [
        "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s",
        "wy_rad_s", "wz_rad_s",
    ];
    let is_finite = |row: &[f64]| row.iter().all(|value| value.is_finite());
    let is_known =
        |range: std::ops::Range<usize>| rows.iter().any(|(_, row)| is_finite(&row[range.clone()]));
    let are_known =
        |range: std::ops::Range<usize>| rows.iter().all(|(_, row)| is_finite(&row[range.clone()]));
    let (has_turns, has_speeds) = (is_known(3..7), are_known(7..13));
    let is_used = |index: usize| match index {
        0..3 => true,
        3..7 => has_turns,
        _ => has_speeds,
    };
    let mut text = String::from("t_s");
    for (_, name) in names
        .iter()
        .enumerate()
        .filter(|(index, _)| is_used(*index))
    {
        text.push(',');
        text.push_str(name);
    }
    for (name, topic) in &actuators {
        let count = topic.rows.first().map_or(0, |(_, values)| values.len());
        for index in 0..count {
            text.push_str(&format!(",{}[{index}]", name.replace('/', ".")));
        }
    }
    text.push('\n');
    for (time_us, row) in &rows {
        push_seconds(
            &mut text,
            i64::try_from(time_us.saturating_mul(1000)).unwrap_or(i64::MAX),
        );
        for (_, value) in row.iter().enumerate().filter(|(index, _)| is_used(*index)) {
            text.push(',');
            push_number(&mut text, *value);
        }
        for (_, topic) in &actuators {
            let count = topic.rows.first().map_or(0, |(_, values)| values.len());
            let held = topic.held(*time_us);
            for index in 0..count {
                text.push(',');
                let value = held.and_then(|values| values.get(index).copied());
                push_number(&mut text, value.unwrap_or(f64::NAN));
            }
        }
        text.push('\n');
    }
    let left: Vec<String> = topics
        .iter()
        .filter(|(own, _)| *own != name && is_path(own))
        .map(words)
        .collect();
    if !left.is_empty() {
        warnings.push(
            Code::ColumnsIgnored.warning(format!("topics that are not read: {}", listed(left))),
        );
    }
    Ok(Decoded { text, warnings })
}
