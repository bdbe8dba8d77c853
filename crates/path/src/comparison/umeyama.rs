//! The best alignment of one set of points with another (Umeyama 1991): a rigid motion, with or without a scale.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Matrix3, Matrix4, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};
use serde::Serialize;

use realgap_core::error::{Error, Result};
use realgap_core::file::look_up;

/// What may be done to the other trajectory before it is compared sample by sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Umeyama {
    /// It stays where it is.
    #[default]
    None,
    /// It is moved and turned onto the reference.
    Se3,
    /// It is moved, turned and scaled onto the reference.
    Sim3,
}

impl Umeyama {
    /// All alignments; the first is the default.
    pub const ALL: [Self; 3] = [Self::None, Self::Se3, Self::Sim3];

    /// The name in options and in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Se3 => "se3",
            Self::Sim3 => "sim3",
        }
    }

    /// The meaning, for a list of choices.
    pub const fn about(self) -> &'static str {
        match self {
            Self::None => "Positions as they are",
            Self::Se3 => "Moved and turned onto the reference, as evo's -a",
            Self::Sim3 => "Moved, turned and scaled onto the reference, as evo's -as",
        }
    }
}

impl fmt::Display for Umeyama {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Umeyama {
    type Err = Error;

    fn from_str(word: &str) -> Result<Self> {
        look_up("alignment", word, Self::ALL, |alignment| alignment.name())
            .map_err(|error| error.into_usage().field("align"))
    }
}

/// A motion with a scale that takes points q to `scale · turn · q + shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Similarity {
    pub(super) scale: f64,
    pub(super) turn: UnitQuaternion<f64>,
    pub(super) shift_m: Vector3<f64>,
}

impl Similarity {
    /// The similarity that takes `other` nearest to `reference`, point by point; with `scales` false its scale is 1.
    ///
    /// The rotation is computed after Horn (1987): it is the same optimum as Umeyama's, always a proper rotation, and also defined
    /// for straight lines and single points. Points that all coincide keep their scale.
    pub(super) fn best(reference: &[Vector3<f64>], other: &[Vector3<f64>], scales: bool) -> Self {
        let n = reference.len() as f64;
        let centre_a = reference.iter().sum::<Vector3<f64>>() / n;
        let centre_b = other.iter().sum::<Vector3<f64>>() / n;
        let centred = reference
            .iter()
            .map(|p| p - centre_a)
            .zip(other.iter().map(|q| q - centre_b));
        let covariance: Matrix3<f64> = centred.clone().map(|(p, q)| q * p.transpose()).sum();
        let turn = best_turn(&covariance);
        let scale = match scales {
            true => {
                let along: f64 = centred.clone().map(|(p, q)| p.dot(&(turn * q))).sum();
                let size: f64 = centred.map(|(_, q)| q.norm_squared()).sum();
                if size > 0.0 { along / size } else { 1.0 }
            }
            false => 1.0,
        };
        Self {
            scale,
            turn,
            shift_m: centre_a - scale * (turn * centre_b),
        }
    }
}

/// The rotation R that maximises Σ p·R q for S = Σ q pᵀ: the eigenvector of Horn's matrix with the largest eigenvalue.
pub(super) fn best_turn(s: &Matrix3<f64>) -> UnitQuaternion<f64> {
    #[rustfmt::skip]
    let horn = Matrix4::new(
        s.m11 + s.m22 + s.m33, s.m23 - s.m32,          s.m31 - s.m13,          s.m12 - s.m21,
        s.m23 - s.m32,         s.m11 - s.m22 - s.m33,  s.m12 + s.m21,          s.m31 + s.m13,
        s.m31 - s.m13,         s.m12 + s.m21,          s.m22 - s.m11 - s.m33,  s.m23 + s.m32,
        s.m12 - s.m21,         s.m31 + s.m13,          s.m23 + s.m32,          s.m33 - s.m11 - s.m22,
    );
    let eigen = SymmetricEigen::new(horn);
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    UnitQuaternion::new_normalize(Quaternion::new(q[0], q[1], q[2], q[3]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moved_turned_and_scaled_set_is_brought_back() {
        let points: Vec<Vector3<f64>> = (0..20)
            .map(f64::from)
            .map(|t| Vector3::new(t.sin(), 0.3 * t, (0.7 * t).cos()))
            .collect();
        let turn = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.5);
        let moved: Vec<Vector3<f64>> = points
            .iter()
            .map(|p| 2.5 * (turn * p) + Vector3::new(3.0, -1.0, 7.0))
            .collect();
        let best = Similarity::best(&points, &moved, true);
        assert!((best.scale - 0.4).abs() < 1e-12);
        for (p, q) in points.iter().zip(&moved) {
            assert!((best.scale * (best.turn * q) + best.shift_m - p).norm() < 1e-12);
        }
        assert_eq!(Similarity::best(&points, &moved, false).scale, 1.0);
    }

    #[test]
    fn points_that_coincide_keep_their_scale() {
        let still = vec![Vector3::new(1.0, 2.0, 3.0); 4];
        let best = Similarity::best(&still, &[Vector3::x(); 4], true);
        assert_eq!(best.scale, 1.0);
        assert!((best.turn * Vector3::x() + best.shift_m - still[0]).norm() < 1e-12);
    }
}
