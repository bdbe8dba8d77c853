//! The six faces of a cube, and the 24 rotations that map a cube onto itself.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// A face of a cube, named by its outward normal in the module's own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Face {
    /// Outward normal +x.
    PosX,
    /// Outward normal −x.
    NegX,
    /// Outward normal +y.
    PosY,
    /// Outward normal −y.
    NegY,
    /// Outward normal +z.
    PosZ,
    /// Outward normal −z.
    NegZ,
}

impl Face {
    /// All six, in the order of their names in files.
    pub const ALL: [Self; 6] = [
        Self::PosX,
        Self::NegX,
        Self::PosY,
        Self::NegY,
        Self::PosZ,
        Self::NegZ,
    ];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PosX => "PosX",
            Self::NegX => "NegX",
            Self::PosY => "PosY",
            Self::NegY => "NegY",
            Self::PosZ => "PosZ",
            Self::NegZ => "NegZ",
        }
    }

    /// The face on the other side.
    pub fn opposite(self) -> Self {
        match self {
            Self::PosX => Self::NegX,
            Self::NegX => Self::PosX,
            Self::PosY => Self::NegY,
            Self::NegY => Self::PosY,
            Self::PosZ => Self::NegZ,
            Self::NegZ => Self::PosZ,
        }
    }

    /// Index of the axis of the face's normal: 0 for x, 1 for y, 2 for z.
    pub(crate) fn axis_index(self) -> usize {
        match self {
            Self::PosX | Self::NegX => 0,
            Self::PosY | Self::NegY => 1,
            Self::PosZ | Self::NegZ => 2,
        }
    }

    /// Outward unit normal in the module's frame.
    pub fn normal(self) -> Vector3<f64> {
        let mut normal = Vector3::zeros();
        normal[self.axis_index()] = match self {
            Self::PosX | Self::PosY | Self::PosZ => 1.0,
            Self::NegX | Self::NegY | Self::NegZ => -1.0,
        };
        normal
    }

    /// True if the two faces lie at right angles.
    pub(crate) fn is_perpendicular_to(self, other: Self) -> bool {
        self.axis_index() != other.axis_index()
    }

    /// The four faces at right angles to this one.
    pub fn perpendicular(self) -> impl Iterator<Item = Self> {
        Self::ALL
            .into_iter()
            .filter(move |&face| face.is_perpendicular_to(self))
    }
}

/// One of the 24 orientations of a cube. The matrix holds only 0, 1 and −1, so that products are exact and positions stay exactly
/// on the lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CubeRotation(Matrix3<f64>);

impl CubeRotation {
    pub(super) fn identity() -> Self {
        Self(Matrix3::identity())
    }

    /// `count` quarter turns, right-handed, about the outward normal of `face`.
    pub(super) fn quarter_turns(face: Face, count: u8) -> Self {
        let axis = face.normal();
        // Rodrigues' formula at 90°: cosine 0, sine 1.
        let quarter = axis * axis.transpose() + axis.cross_matrix();
        (0..count % 4).fold(Self::identity(), |turned, _| turned.then(Self(quarter)))
    }

    /// The canonical rotation that maps the outward normal of `from` onto that of `to`: the identity if they agree, a quarter
    /// turn if they are at right angles, and a half turn about z (about x for the faces ±z) if they are opposite.
    pub(super) fn between(from: Face, to: Face) -> Self {
        if from == to {
            return Self::identity();
        }
        if from == to.opposite() {
            let about = if from.axis_index() == 2 {
                Face::PosX
            } else {
                Face::PosZ
            };
            return Self::quarter_turns(about, 2);
        }
        let axis = from.normal().cross(&to.normal());
        Face::ALL
            .into_iter()
            .find(|face| face.normal() == axis)
            .map_or(Self::identity(), |about| Self::quarter_turns(about, 1))
    }

    /// This rotation followed by `next`, both about fixed axes.
    pub(super) fn then(self, next: Self) -> Self {
        Self(next.0 * self.0)
    }

    pub(super) fn apply(self, vector: Vector3<f64>) -> Vector3<f64> {
        // Adding zero turns −0 into 0, which is easier to read in results.
        (self.0 * vector).add_scalar(0.0)
    }

    /// Extents of an axis-aligned box after the rotation.
    pub(super) fn apply_to_extents(self, extents: Vector3<f64>) -> Vector3<f64> {
        self.0.abs() * extents
    }

    pub(super) fn quaternion(self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_brings_every_face_onto_every_other() {
        for from in Face::ALL {
            for to in Face::ALL {
                let rotation = CubeRotation::between(from, to);
                assert_eq!(rotation.apply(from.normal()), to.normal());
                assert_eq!(rotation.0.determinant(), 1.0);
            }
        }
    }

    #[test]
    fn quarter_turns_are_right_handed_and_four_make_a_full_turn() {
        let turn = CubeRotation::quarter_turns(Face::PosZ, 1);
        assert_eq!(turn.apply(Vector3::x()), Vector3::y());
        for face in Face::ALL {
            let turns =
                CubeRotation::quarter_turns(face, 3).then(CubeRotation::quarter_turns(face, 1));
            assert_eq!(turns, CubeRotation::identity());
        }
    }
}
