//! Vectors, matrices and poses as the engine takes them, and back.

use nalgebra::{Isometry3, Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::precision::math::{Matrix, Pose, Rotation, Vector};
use super::precision::{narrow, wide};

pub(crate) fn to_vector(v: &Vector3<f64>) -> Vector {
    Vector::new(narrow(v.x), narrow(v.y), narrow(v.z))
}

pub(crate) fn from_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(wide(v.x), wide(v.y), wide(v.z))
}

pub(crate) fn to_matrix(m: &Matrix3<f64>) -> Matrix {
    Matrix::from_cols(
        to_vector(&m.column(0).into_owned()),
        to_vector(&m.column(1).into_owned()),
        to_vector(&m.column(2).into_owned()),
    )
}

pub(crate) fn to_pose(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    Pose::from_parts(
        to_vector(&pose.translation.vector),
        Rotation::from_xyzw(narrow(q.i), narrow(q.j), narrow(q.k), narrow(q.w)),
    )
}

pub(crate) fn from_rotation(rotation: &Rotation) -> UnitQuaternion<f64> {
    from_quaternion(Quaternion::new(
        wide(rotation.w),
        wide(rotation.x),
        wide(rotation.y),
        wide(rotation.z),
    ))
}

/// A unit quaternion in f64 as it is.
#[cfg(feature = "f64")]
fn from_quaternion(rotation: Quaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(rotation)
}

/// A unit quaternion in f32 is one in f64 to seven digits only, and everything else counts on sixteen.
#[cfg(not(feature = "f64"))]
fn from_quaternion(rotation: Quaternion<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(rotation)
}

pub(crate) fn from_pose(pose: &Pose) -> Isometry3<f64> {
    Isometry3::from_parts(
        from_vector(pose.translation).into(),
        from_rotation(&pose.rotation),
    )
}
