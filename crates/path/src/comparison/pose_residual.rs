//! The single errors of the metric `pose`, for least squares: how far the simulated body is from the recorded one, seen from the
//! recorded body.

use super::joint;
use super::metric::Pair;
use crate::trajectory::{Interpolator, JointTrack, Trajectory};
use nalgebra::{UnitQuaternion, Vector3};

/// What one error of a pose is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseQuantity {
    /// Position along the recorded forward direction, metres.
    Forward,
    /// Position to the left of it, metres.
    Left,
    /// Height, metres.
    Up,
    /// Rotation about the recorded forward direction, radians.
    Roll,
    /// Rotation about the left, radians.
    Pitch,
    /// Rotation about the vertical, radians.
    Heading,
}

impl PoseQuantity {
    /// All of them, in the order of their errors.
    pub const ALL: [Self; 6] = [
        Self::Forward,
        Self::Left,
        Self::Up,
        Self::Roll,
        Self::Pitch,
        Self::Heading,
    ];

    /// What this is called, with its unit.
    pub fn column(self) -> &'static str {
        match self {
            Self::Forward => "forward_m",
            Self::Left => "left_m",
            Self::Up => "up_m",
            Self::Roll => "roll_rad",
            Self::Pitch => "pitch_rad",
            Self::Heading => "heading_rad",
        }
    }

    /// Number among all quantities.
    pub fn number(self) -> usize {
        self as usize
    }

    /// Those that a recording can have: of a path in a plane three.
    fn of(recorded: &Trajectory) -> impl Iterator<Item = Self> {
        let is_planar = recorded.is_planar();
        let all = Self::ALL.into_iter();
        all.filter(move |one| {
            !is_planar || matches!(one, Self::Forward | Self::Left | Self::Heading)
        })
    }

    /// The error of this quantity among those of position and rotation.
    fn pick(self, [place_m, turn_rad]: &[Vector3<f64>; 2]) -> f64 {
        match self {
            Self::Forward => place_m.x,
            Self::Left => place_m.y,
            Self::Up => place_m.z,
            Self::Roll => turn_rad.x,
            Self::Pitch => turn_rad.y,
            Self::Heading => turn_rad.z,
        }
    }
}

/// Position and rotation of the simulated body as seen from the recorded one at a sample. The axes are the recorded heading's: forward,
/// left and up, so that errors along and across the motion do not mix.
fn difference(
    recorded: (Vector3<f64>, UnitQuaternion<f64>),
    simulated: (Vector3<f64>, UnitQuaternion<f64>),
) -> [Vector3<f64>; 2] {
    let (_, _, heading_rad) = recorded.1.euler_angles();
    let level = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    let turn = simulated.1 * recorded.1.inverse();
    [
        level.inverse() * (simulated.0 - recorded.0),
        level.inverse() * turn.scaled_axis(),
    ]
}

/// One series of errors among those of a pose, which come quantity after quantity and then joint after joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PoseSeries<'a> {
    /// A quantity of the pose.
    Pose(PoseQuantity),
    /// The angle of a joint that was recorded beside the pose.
    Joint(&'a JointTrack),
}

/// The series of a recording in their order, and the number of errors of each; `is_simulated` tells which joints the robot has.
pub fn pose_error_series<'a>(
    real: &'a Trajectory,
    is_simulated: impl Fn(&str) -> bool,
    most: usize,
) -> (Vec<PoseSeries<'a>>, usize) {
    let joints = real.joints().iter();
    let joints = joints
        .filter(|joint| is_simulated(&joint.name))
        .map(PoseSeries::Joint);
    let series: Vec<PoseSeries<'a>> = PoseQuantity::of(real)
        .map(PoseSeries::Pose)
        .chain(joints)
        .collect();
    let count = joint::samples(real.len(), series.len(), most).count();
    (series, count)
}

/// The single errors of [`pose_error_series`]; `None` without orientations in both trajectories.
pub(super) fn pose_residuals(pair: &Pair<'_>, most: usize) -> Option<Vec<f64>> {
    let turns = pair.real.orientations_world_from_body()?;
    pair.simulated.orientations_world_from_body()?;
    let times_s = pair.real.times_s();
    let mut at = Interpolator::new(pair.simulated);
    let has = |name: &str| pair.simulated.joint(name).is_some();
    let (series, _) = pose_error_series(pair.real, has, most);
    let chosen: Vec<usize> = joint::samples(times_s.len(), series.len(), most).collect();
    let mut poses = Vec::with_capacity(chosen.len());
    for sample in &chosen {
        let since_start_s = times_s[*sample] - times_s[0];
        let recorded = (pair.real.positions_world_m()[*sample], turns[*sample]);
        let turn = at.orientation_world_from_body(since_start_s)?;
        poses.push(difference(
            recorded,
            (at.position_world_m(since_start_s), turn),
        ));
    }
    let mut errors = Vec::with_capacity(series.len() * chosen.len());
    for one in series {
        match one {
            PoseSeries::Pose(quantity) => {
                errors.extend(poses.iter().map(|pose| quantity.pick(pose)))
            }
            PoseSeries::Joint(recorded) => {
                let simulated = pair.simulated.joint(&recorded.name)?;
                let mut at = Interpolator::new(pair.simulated);
                for sample in &chosen {
                    let since_start_s = times_s[*sample] - times_s[0];
                    errors.push(joint::difference_rad(
                        &(recorded, simulated),
                        &mut at,
                        since_start_s,
                        *sample,
                    ));
                }
            }
        }
    }
    Some(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_that_is_ahead_and_turned_has_errors_along_its_own_way() {
        let heading = |rad: f64| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rad);
        let quarter = std::f64::consts::FRAC_PI_2;
        // The recorded body looks along +y; the simulated one is 3 m ahead, 1 m to its right, and turned by 0.1 rad more.
        let recorded = (Vector3::new(5.0, 1.0, 0.0), heading(quarter));
        let simulated = (Vector3::new(6.0, 4.0, 0.5), heading(quarter + 0.1));
        let errors = difference(recorded, simulated);
        let all = PoseQuantity::ALL.map(|quantity| quantity.pick(&errors));
        for (is, right) in all.into_iter().zip([3.0, -1.0, 0.5, 0.0, 0.0, 0.1]) {
            assert!((is - right).abs() < 1e-12, "{all:?}");
        }
    }
}
