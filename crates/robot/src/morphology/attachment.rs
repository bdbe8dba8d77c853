//! Attachments: rigid connections between the faces of two modules.

use nalgebra::Vector3;

use super::face::{CubeRotation, Face};

/// A rigid connection of two modules. The child's face lies on the parent's face without a gap, and their centres coincide.
///
/// The child is rotated so that its `child_face` points at the parent: by no rotation if `child_face` is opposite to `face` (the
/// default), by a quarter turn if the two are at right angles, and by a half turn about the parent's z axis (x axis for the faces
/// ±z) if the two have the same name. Then it is turned by `quarter_turns` × 90° about the outward normal of the parent's face,
/// right-handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attachment {
    /// Index of the parent module.
    pub parent: usize,
    /// Face of the parent, in the parent's frame.
    pub face: Face,
    /// Index of the child module.
    pub child: usize,
    /// Face of the child, in the child's frame.
    pub child_face: Face,
    /// Number of quarter turns about the outward normal of the parent's face, 0 to 3.
    pub quarter_turns: u8,
}

impl Attachment {
    /// Rotation of the child in the frame of the parent.
    pub(super) fn parent_from_child(&self) -> CubeRotation {
        CubeRotation::between(self.child_face, self.face.opposite())
            .then(CubeRotation::quarter_turns(self.face, self.quarter_turns))
    }

    /// Centre of the child in the frame of the parent, m.
    pub(super) fn child_centre_m(
        &self,
        parent_sides_m: &Vector3<f64>,
        child_sides_m: &Vector3<f64>,
    ) -> Vector3<f64> {
        let parent_side_m = parent_sides_m[self.face.axis_index()];
        let child_side_m = child_sides_m[self.child_face.axis_index()];
        self.face.normal() * ((parent_side_m + child_side_m) / 2.0)
    }
}
