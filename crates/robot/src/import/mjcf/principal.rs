//! Principal moments and axes of meshes as MuJoCo's compiler rounds them.
//!
//! MuJoCo keeps principal moments and a quaternion of a mesh instead of a tensor. Its Jacobi iteration ends while elements beside the
//! diagonal are left, up to 1e-7 of the tensor, and drops them; the same iteration here gives the same numbers.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Elements beside the diagonal below this fraction of the largest element end the iteration.
const SMALL: f64 = 1e-7;
/// Largest number of rotations.
const MOST_TURNS: usize = 500;

/// Principal moments, the largest first, and the orientation of their axes.
pub(super) fn principal(tensor: &Matrix3<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let mut turn = UnitQuaternion::identity();
    let mut moments = tensor.diagonal();
    for _ in 0..MOST_TURNS {
        let axes = turn.to_rotation_matrix();
        let turned = axes.matrix().transpose() * tensor * axes.matrix();
        moments = turned.diagonal();
        let size = |row: usize, column: usize| turned[(row, column)].abs();
        let (row, column, about) = if size(0, 1) > size(0, 2) && size(0, 1) > size(1, 2) {
            (0, 1, 2)
        } else if size(0, 2) > size(1, 2) {
            (0, 2, 1)
        } else {
            (1, 2, 0)
        };
        let off = turned[(row, column)];
        if off.abs() <= SMALL * tensor.amax() {
            break;
        }
        let tau = (turned[(column, column)] - turned[(row, row)]) / (2.0 * off);
        let root = (1.0 + tau * tau).sqrt();
        let tangent = if tau >= 0.0 {
            1.0 / (tau + root)
        } else {
            -1.0 / (root - tau)
        };
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        let half = (0.5 - 0.5 * cosine).sqrt();
        let half = if (tau >= 0.0) == (about == 1) {
            half
        } else {
            -half
        };
        let mut axis = Vector3::zeros();
        axis[about] = half;
        turn = then(&turn, (1.0 - half * half).sqrt(), axis);
    }
    for first in [0, 1, 0] {
        if moments[first] < moments[first + 1] {
            moments.swap_rows(first, first + 1);
            let mut axis = Vector3::zeros();
            axis[(first + 2) % 3] = std::f64::consts::FRAC_1_SQRT_2;
            turn = then(&turn, std::f64::consts::FRAC_1_SQRT_2, axis);
        }
    }
    (moments, turn)
}

/// A rotation followed by another one about its own axes.
fn then(turn: &UnitQuaternion<f64>, real: f64, axis: Vector3<f64>) -> UnitQuaternion<f64> {
    let next = Quaternion::from_parts(real, axis);
    UnitQuaternion::new_normalize(turn.quaternion() * next)
}

/// A tensor as MuJoCo keeps it.
pub(super) fn stored(of: &Matrix3<f64>) -> Matrix3<f64> {
    let (moments, turn) = principal(of);
    let axes = turn.to_rotation_matrix();
    axes.matrix() * Matrix3::from_diagonal(&moments) * axes.matrix().transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tensor_returns_from_its_principal_axes_to_the_accuracy_of_mujoco() {
        for (a, b, c) in [(0.3, 0.1, -0.2), (1e-7, 0.0, 2e-8), (0.0, 0.0, 0.9)] {
            let own = Matrix3::new(2.0, a, b, a, 3.0, c, b, c, 4.0);
            let (moments, _) = principal(&own);
            assert!(
                moments.x >= moments.y && moments.y >= moments.z,
                "{moments}"
            );
            assert!((stored(&own) - own).amax() < 1e-6);
        }
    }
}
