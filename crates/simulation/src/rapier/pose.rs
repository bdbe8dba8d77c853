//! Conversion of vectors, matrices and poses between nalgebra and Rapier.

use nalgebra::{Isometry3, Matrix3, Quaternion, UnitQuaternion, Vector3};

use rapier3d_f64::math::{Matrix, Pose, Rotation, Vector};

pub(crate) fn to_vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

pub(crate) fn from_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
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
        Rotation::from_xyzw(q.i, q.j, q.k, q.w),
    )
}

pub(crate) fn from_rotation(rotation: &Rotation) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(
        rotation.w, rotation.x, rotation.y, rotation.z,
    ))
}

pub(crate) fn from_pose(pose: &Pose) -> Isometry3<f64> {
    Isometry3::from_parts(
        from_vector(pose.translation).into(),
        from_rotation(&pose.rotation),
    )
}
