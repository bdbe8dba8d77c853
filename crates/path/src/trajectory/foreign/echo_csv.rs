//! What `ros2 topic echo --csv` prints: a line for each message with nothing but its values, one after another. Layouts of messages with a
//! header are known by the number and the kind of their values: seconds, nanoseconds, frame, then what the message holds.

use super::ForeignTable;
use super::flat::{Flat, cells, plain};
use super::joint_rows::QUANTITIES;
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, excerpt, first_line};
use realgap_core::error::{Advice, Error, Result};

/// Lines of `ros2 topic echo --csv` with poses, odometry, transforms or joints.
pub const ECHO_CSV: ForeignTable = ForeignTable {
    name: "topic-echo-csv",
    doc: "what `ros2 topic echo` prints as CSV of PoseStamped, PoseWithCovarianceStamped, Odometry, TransformStamped, TFMessage and JointState",
    extensions: &["csv", "txt"],
    recognises: |bytes| {
        let mut lines = [first_line(bytes)]
            .into_iter()
            .filter(|line| is_message(line));
        lines.any(|line| Kind::of_line(line).is_some())
    },
    table,
    beside: None,
};

/// Values of a pose: place, then quaternion with its real part last.
const POSE: [&str; 7] = ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"];
/// Values of a covariance.
const COVARIANCE: usize = 36;
/// Values of one transform: stamp, two frames, pose.
const TRANSFORM: usize = 11;
/// Values of the header: stamp and frame.
const HEADER: usize = 3;
/// Where a message with a child frame has it.
const CHILD: usize = 3;

/// The kind of message, as the values of a line show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A pose at this value; what follows is not read.
    Pose { at: usize, of: &'static str },
    /// So many transforms.
    Transforms(usize),
    /// So many joints, with so many lists of values.
    Joints { count: usize, lists: usize },
}

impl Kind {
    fn of_line(line: &str) -> Option<Self> {
        Self::of(&cells(line, 1, Separator::Comma).ok()?)
    }

    fn of(row: &[&str]) -> Option<Self> {
        let is_number = |at: usize| row.get(at).is_some_and(|cell| cell.parse::<f64>().is_ok());
        let is_text = |at: usize| row.get(at).is_some() && !is_number(at);
        let are_numbers = |from: usize| (from..row.len()).all(is_number);
        stamp(row, 0)?;
        if !is_text(HEADER - 1) {
            return None;
        }
        if are_numbers(HEADER) {
            let of = match row.len() - HEADER {
                7 => "PoseStamped",
                n if n == 7 + COVARIANCE => "PoseWithCovarianceStamped",
                _ => return None,
            };
            return Some(Self::Pose { at: HEADER, of });
        }
        let is_transform = |from: usize| {
            let is_headed =
                stamp(row, from).is_some() && is_text(from + 2) && is_text(from + CHILD);
            is_headed && (from + 4..from + TRANSFORM).all(is_number)
        };
        let transforms = row.len() / TRANSFORM;
        if row.len().is_multiple_of(TRANSFORM)
            && (0..transforms).all(|k| is_transform(k * TRANSFORM))
        {
            return Some(Self::Transforms(transforms));
        }
        let of_odometry = 2 * COVARIANCE + 7 + 6;
        if row.len() == CHILD + 1 + of_odometry && are_numbers(CHILD + 1) {
            let (at, of) = (CHILD + 1, "Odometry");
            return Some(Self::Pose { at, of });
        }
        let count = (HEADER..row.len()).take_while(|at| is_text(*at)).count();
        let values = row.len() - HEADER - count;
        let lists = values / count.max(1);
        let is_joints = count > 0 && (1..=3).contains(&lists) && values == lists * count;
        (is_joints && are_numbers(HEADER + count)).then_some(Self::Joints { count, lists })
    }
}

/// The time whose seconds stand at this value, with all its digits.
fn stamp(row: &[&str], at: usize) -> Option<String> {
    let seconds: u64 = row.get(at)?.parse().ok()?;
    let nanoseconds: u64 = row.get(at + 1)?.parse().ok()?;
    (nanoseconds < 1_000_000_000).then(|| format!("{seconds}.{nanoseconds:09}"))
}

/// False for blank lines and for what `topic echo` says between messages.
fn is_message(line: &str) -> bool {
    let is_said = ["A message was lost", "total count"];
    let line = line.trim();
    !line.is_empty() && line != "---" && !is_said.iter().any(|words| line.starts_with(words))
}

fn table(bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| is_message(line));
    let rows =
        lines.map(|(index, line)| Ok((index + 1, cells(line, index + 1, Separator::Comma)?)));
    let mut rows: Vec<(usize, Vec<&str>)> = rows.collect::<Result<_>>()?;
    let Some(first) = rows.first().and_then(|(_, row)| Kind::of(row)) else {
        return Err(Error::invalid("there is no message").at_line(1, 1));
    };
    // The last line may be cut off, as by Ctrl-C.
    let is_cut = rows.len() > 1 && rows.last().is_some_and(|(_, row)| !is_as(first, row));
    if is_cut {
        rows.pop();
    }
    for (number, row) in &rows {
        if row.contains(&"...") {
            return Err(Error::invalid("the message is shortened")
                .at_line(*number, 1)
                .hint("let `ros2 topic echo` print messages in full length, or record a bag: ros2 bag record TOPIC"));
        }
        if !is_as(first, row) {
            return Err(Error::invalid("the messages have different parts")
                .at_line(*number, 1)
                .found(excerpt(&row.join(",")))
                .allowed("messages of one topic, each with the same parts")
                .hint("record a bag instead: ros2 bag record TOPIC"));
        }
    }
    let mut flat = match first {
        Kind::Pose { at, of } => poses(&rows, at, of)?,
        Kind::Transforms(_) => transforms(&rows, reading)?,
        Kind::Joints { count, lists } => joints(&rows, count, lists)?,
    };
    if is_cut {
        flat.read_as("the last line is left out: that message is not whole");
    }
    Ok(flat.decoded())
}

/// True if a row is a message of this kind; messages of transforms may differ in their number.
fn is_as(kind: Kind, row: &[&str]) -> bool {
    match (kind, Kind::of(row)) {
        (Kind::Transforms(_), Some(Kind::Transforms(_))) => true,
        (kind, found) => found == Some(kind),
    }
}

fn pose_table() -> Result<Flat> {
    let names = std::iter::once("t_s").chain(POSE);
    Flat::new(names.map(str::to_owned))
}

fn push_pose(flat: &mut Flat, row: &[&str], stamp_at: usize, at: usize) -> Result<()> {
    let time = stamp(row, stamp_at).unwrap_or_default();
    let pose = row[at..at + POSE.len()]
        .iter()
        .map(|cell| (*cell).to_owned());
    flat.push(std::iter::once(time).chain(pose))
}

fn poses(rows: &[(usize, Vec<&str>)], at: usize, of: &str) -> Result<Flat> {
    let mut flat = pose_table()?;
    for (_, row) in rows {
        push_pose(&mut flat, row, 0, at)?;
    }
    flat.read_as(format!(
        "lines that `topic echo` prints as CSV, whose number and kinds of values are those of {of}: the pose is read, in metres"
    ));
    if of != "PoseStamped" {
        flat.not_read("covariances and velocities are not read");
    }
    Ok(flat)
}

fn transforms(rows: &[(usize, Vec<&str>)], reading: &Reading) -> Result<Flat> {
    // The frames of every transform, in the order in which they come first.
    let mut frames: Vec<(&str, &str)> = Vec::new();
    for (_, row) in rows {
        for one in row.chunks(TRANSFORM) {
            let pair = (one[CHILD], one[HEADER - 1]);
            if !frames.contains(&pair) {
                frames.push(pair);
            }
        }
    }
    let named = |(child, parent): &(&str, &str)| format!("{child} in {parent}");
    let wanted = reading.child_frame.as_deref();
    let is_wanted = |pair: &&(&str, &str)| {
        wanted.is_none_or(|wanted| wanted == pair.0 || wanted == named(pair))
    };
    let chosen: Vec<&(&str, &str)> = frames.iter().filter(is_wanted).collect();
    let [chosen] = chosen.as_slice() else {
        let all: Vec<String> = frames.iter().map(named).collect();
        return Err(Error::usage("the file holds transforms of several frames")
            .at_line(1, 1)
            .field("child_frame")
            .found(all.join(", "))
            .allowed("one of them; chains of transforms are followed in bags only")
            .advise(Advice::Topic));
    };
    let mut flat = pose_table()?;
    for (_, row) in rows {
        for (k, one) in row.chunks(TRANSFORM).enumerate() {
            if (one[CHILD], one[HEADER - 1]) == **chosen {
                push_pose(&mut flat, row, k * TRANSFORM, k * TRANSFORM + CHILD + 1)?;
            }
        }
    }
    flat.read_as(format!(
        "lines that `topic echo` prints as CSV, whose number and kinds of values are those of transforms: {} is read, in metres",
        named(chosen)
    ));
    Ok(flat)
}

fn joints(rows: &[(usize, Vec<&str>)], count: usize, lists: usize) -> Result<Flat> {
    let names_at = HEADER..HEADER + count;
    let names: Vec<&str> = rows[0].1[names_at.clone()].to_vec();
    for (number, row) in rows {
        if row[names_at.clone()] != names {
            return Err(Error::invalid("the joints change their order")
                .at_line(*number, 1)
                .found(excerpt(&row[names_at.clone()].join(", ")))
                .allowed(excerpt(&names.join(", ")))
                .hint("record a bag instead: ros2 bag record TOPIC"));
        }
    }
    // Two lists are angles with speeds, or with efforts: empty lists leave no sign in a line.
    let has_speeds = lists == 3 || (lists == 2 && is_slope(rows, count));
    let kept = match (lists, has_speeds) {
        (2, false) => 1,
        _ => lists,
    };
    let columns = QUANTITIES.iter().take(kept).flat_map(|(_, unit)| {
        let of_joint = move |name: &&str| format!("{}_{unit}", plain(name));
        names.iter().map(of_joint)
    });
    let mut flat = Flat::new(std::iter::once("t_s".to_owned()).chain(columns))?;
    for (_, row) in rows {
        let time = stamp(row, 0).unwrap_or_default();
        let values = &row[names_at.end..names_at.end + kept * count];
        let values = values.iter().map(|cell| (*cell).to_owned());
        flat.push(std::iter::once(time).chain(values))?;
    }
    flat.read_as(format!(
        "lines that `topic echo` prints as CSV, whose number and kinds of values are those of JointState: {}, in radians as ROS defines them",
        match kept {
            1 => "angles",
            2 => "angles and speeds",
            _ => "angles, speeds and efforts",
        }
    ));
    if kept < lists {
        flat.not_read(
            "the second list of values is not read: nothing says whether it holds speeds or efforts, and it is not the slope of the angles",
        );
    }
    Ok(flat)
}

/// True if the second list of values is the slope of the first: the angles' changes follow it to within a third.
fn is_slope(rows: &[(usize, Vec<&str>)], count: usize) -> bool {
    let value = |row: &[&str], list: usize, joint: usize| {
        let at = HEADER + count + list * count + joint;
        row[at].parse::<f64>().ok()
    };
    let time_s = |row: &[&str]| stamp(row, 0)?.parse::<f64>().ok();
    let (mut missed, mut moved) = (0.0, 0.0);
    for pair in rows.windows(2) {
        let (one, next) = (&pair[0].1, &pair[1].1);
        let Some((from_s, to_s)) = time_s(one).zip(time_s(next)) else {
            continue;
        };
        for joint in 0..count {
            let angles = value(one, 0, joint).zip(value(next, 0, joint));
            let speeds = value(one, 1, joint).zip(value(next, 1, joint));
            if let Some(((a, b), (v, w))) = angles.zip(speeds) {
                missed += ((b - a) - 0.5 * (v + w) * (to_s - from_s)).abs();
                moved += (b - a).abs();
            }
        }
    }
    moved > 0.0 && missed < moved / 3.0
}
