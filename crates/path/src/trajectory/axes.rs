//! Which way the axes of recorded poses point: some programs write poses of a camera, in a camera's world.

use std::fmt;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::Trajectory;
use realgap_core::error::{Error, Result};

realgap_core::spelled! {
    /// Axes of the world and of the body in a file.
    Axes.name, "names no axes";
    /// As here: z up.
    World "world";
    /// Those of a camera, in KITTI's own files and many of visual odometry: x to the right, y down, z forward; both of the body
    /// and of the world, which is where the first camera was.
    Camera "camera";
}

impl Axes {
    /// The same motion with x forward, y to the left, z up.
    pub(super) fn to_world(self, trajectory: Trajectory) -> Result<Trajectory> {
        match self {
            Self::World => Ok(trajectory),
            Self::Camera => from_camera(&trajectory),
        }
    }
}

fn from_camera(camera: &Trajectory) -> Result<Trajectory> {
    if camera.is_planar() {
        return Err(
            Error::invalid("axes of a camera need all three coordinates")
                .field("axes")
                .found("a recording without z"),
        );
    }
    let turned = |v: &Vector3<f64>| Vector3::new(v.z, -v.x, -v.y);
    let all = |v: &[Vector3<f64>]| v.iter().map(turned).collect::<Vec<_>>();
    let turn = Rotation3::from_matrix_unchecked(Matrix3::new(
        0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0,
    ));
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
    let mut world = Trajectory::new(camera.times_s().to_vec(), all(camera.positions_world_m()))?;
    if let Some(orientations) = camera.orientations_world_from_body() {
        let orientations = orientations.iter().map(|q| turn * q * turn.inverse());
        world = world.with_orientations(orientations.collect())?;
    }
    if let (Some(linear), Some(angular)) = (
        camera.velocities_world_m_s(),
        camera.angular_velocities_body_rad_s(),
    ) {
        world = world.with_velocities(all(linear), all(angular))?;
    }
    world.with_joints(camera.joints().to_vec())
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "axes of the {}", self.name())
    }
}
