//! The directions of the axes of recorded poses, and the conversion of other conventions to z up.

use std::fmt;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::Trajectory;
use realgap_core::error::{Error, Result};

realgap_core::string_enum! {
    /// Axes of the world and of the body in a file.
    Axes.name, "names no axes";
    /// The axes of realgap: x forward, y to the left, z up.
    World "world";
    /// Axes of a camera, as in KITTI's own files and many of visual odometry: x to the right, y down, z forward, for the body
    /// and for the world, whose frame is that of the first camera.
    Camera "camera";
    /// x to the right, y up, z backward, as in much motion capture and computer graphics, for the body and for the world.
    YUp "y-up";
    /// x forward, y to the right, z down, as for aircraft, for the body and for the world.
    ZDown "z-down";
}

impl Axes {
    /// The same trajectory with x forward, y to the left, z up.
    pub(super) fn to_world(self, trajectory: Trajectory) -> Result<Trajectory> {
        match self {
            Self::World => Ok(trajectory),
            // The rows give x, y and z of the world in terms of the file's axes.
            Self::Camera => turned(
                &trajectory,
                Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0),
            ),
            Self::YUp => turned(
                &trajectory,
                Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
            ),
            Self::ZDown => turned(
                &trajectory,
                Matrix3::new(1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0),
            ),
        }
    }
}

fn turned(there: &Trajectory, turn: Matrix3<f64>) -> Result<Trajectory> {
    // Every entry is 0 or ±1, so no number is rounded. The body's axes turn together with those of the world.
    let turn = Rotation3::from_matrix_unchecked(turn);
    moved(there, ("axes", turn), Vector3::zeros(), turn)
}

/// The same trajectory, turned by `turn` about `centre_m`, with the body's own axes turned by `own`; `field` names the setting in errors.
pub(super) fn moved(
    there: &Trajectory,
    (field, turn): (&str, Rotation3<f64>),
    centre_m: Vector3<f64>,
    own: Rotation3<f64>,
) -> Result<Trajectory> {
    if there.is_planar() {
        return Err(
            Error::invalid("only a recording with all three coordinates can be turned")
                .field(field)
                .found("a recording without z"),
        );
    }
    let all = |v: &[Vector3<f64>]| v.iter().map(|v| turn * v).collect::<Vec<_>>();
    let [turn_q, own_q] = [turn, own].map(|turn| UnitQuaternion::from_rotation_matrix(&turn));
    let positions = there.positions_world_m().iter();
    let positions = positions.map(|p| centre_m + turn * (p - centre_m));
    let mut world = Trajectory::new(there.times_s().to_vec(), positions.collect())?;
    if let Some(orientations) = there.orientations_world_from_body() {
        let orientations = orientations.iter().map(|q| turn_q * q * own_q.inverse());
        world = world.with_orientations(orientations.collect())?;
    }
    if let Some([linear, angular]) = there.velocities() {
        let angular = angular.iter().map(|v| own * v);
        world = world.with_velocities(all(linear), angular.collect())?;
    }
    world.with_joints(there.joints().to_vec())
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World | Self::Camera => write!(f, "axes of the {}", self.name()),
            Self::YUp | Self::ZDown => write!(f, "axes {}", self.name()),
        }
    }
}
