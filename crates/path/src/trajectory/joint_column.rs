//! Columns of joints: `NAME_rad`, an angle, and `NAME_rad_s`, its speed, for any number of names.

use super::JointTrack;
use realgap_core::error::Result;

/// Where a joint stands in a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct JointColumns {
    /// Name of the joint.
    pub name: String,
    /// Column of the angle.
    pub angle: usize,
    /// Column of the speed.
    pub speed: Option<usize>,
}

const ANGLE: &str = "_rad";
const SPEED: &str = "_rad_s";
/// Angles that are of the whole body.
const ATTITUDE: [&str; 5] = ["heading", "yaw", "pitch", "roll", "theta"];

/// The joints among the columns that nothing else uses; their columns are marked as used.
pub(super) fn find(names: &[&str], used: &mut [bool]) -> Vec<JointColumns> {
    let mut joints = Vec::new();
    for angle in 0..names.len() {
        let Some(name) = names[angle].strip_suffix(ANGLE).filter(|n| !n.is_empty()) else {
            continue;
        };
        if used[angle] || ATTITUDE.contains(&name) {
            continue;
        }
        let speed_name = format!("{name}{SPEED}");
        let speed = names.iter().position(|other| *other == speed_name);
        let speed = speed.filter(|index| !used[*index]);
        used[angle] = true;
        if let Some(speed) = speed {
            used[speed] = true;
        }
        joints.push(JointColumns {
            name: name.to_owned(),
            angle,
            speed,
        });
    }
    joints
}

/// Adds one line to the joints.
pub(super) fn push(
    joints: &mut Vec<JointTrack>,
    columns: &[JointColumns],
    number: impl Fn(usize) -> Result<f64>,
) -> Result<()> {
    if joints.is_empty() {
        joints.extend(columns.iter().map(|column| JointTrack {
            name: column.name.clone(),
            angles_rad: Vec::new(),
            speeds_rad_s: column.speed.map(|_| Vec::new()),
        }));
    }
    for (joint, column) in joints.iter_mut().zip(columns) {
        joint.angles_rad.push(number(column.angle)?);
        if let (Some(speeds), Some(speed)) = (&mut joint.speeds_rad_s, column.speed) {
            speeds.push(number(speed)?);
        }
    }
    Ok(())
}
