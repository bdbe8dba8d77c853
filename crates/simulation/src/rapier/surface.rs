//! Conversion of the shapes of solids into Parry shapes.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::to_vector;
use rapier3d_f64::math::Vector;
use rapier3d_f64::parry::shape::HeightFieldFlags;
use rapier3d_f64::parry::utils::Array2;
use rapier3d_f64::prelude::SharedShape;
use realgap_robot::morphology::Shape;
use realgap_sensing::arena::HeightField;

/// Thickness that replaces the zero thickness of a flat hull, metres.
const THIN_M: f64 = 1e-4;

/// A Parry shape.
pub(crate) struct Surface {
    /// The shape in Parry's own frame.
    pub shape: SharedShape,
    /// Whether Parry's axis of the shape is y while realgap's is z.
    is_along_y: bool,
}

/// A height field in Parry's own frame, whose y is up and whose z goes down the rows, and that frame in the field's own. Both
/// engines have its triangles.
pub(crate) fn field_shape(field: &HeightField, scale: f64) -> (SharedShape, Isometry3<f64>) {
    let (rows, columns) = (field.rows(), field.columns());
    let heights = (0..columns).flat_map(|column| (0..rows).map(move |row| (row, column)));
    let heights = heights.map(|(row, column)| scale * field.at(row, column));
    let shape = SharedShape::heightfield_with_flags(
        Array2::new(rows, columns, heights.collect()),
        Vector::new(field.size_m[0], 1.0, field.size_m[1]),
        HeightFieldFlags::FIX_INTERNAL_EDGES,
    );
    let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    (
        shape,
        Isometry3::from_parts(Vector3::zeros().into(), upright),
    )
}

impl std::fmt::Debug for Surface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Surface({:?})", self.shape.shape_type())
    }
}

impl Surface {
    /// The surface of a shape, with rounded edges for boxes; `None` for a shape without a surface.
    pub fn new(shape: &Shape, edge_radius_m: f64) -> Option<Self> {
        let mut is_along_y = false;
        let cuboid = |half_m: &Vector3<f64>| {
            let half = to_vector(half_m);
            SharedShape::cuboid(half.x, half.y, half.z)
        };
        let shape = match shape {
            Shape::Nothing => return None,
            Shape::Box { half_extents_m } if edge_radius_m > 0.0 => {
                let (h, r) = (to_vector(half_extents_m), edge_radius_m);
                SharedShape::round_cuboid(h.x - r, h.y - r, h.z - r, r)
            }
            Shape::Box { half_extents_m } => cuboid(half_extents_m),
            Shape::Sphere { radius_m } => SharedShape::ball(*radius_m),
            Shape::Cylinder {
                radius_m,
                half_length_m,
            } => {
                is_along_y = true;
                SharedShape::cylinder(*half_length_m, *radius_m)
            }
            Shape::Capsule {
                radius_m,
                half_length_m,
            } => SharedShape::capsule_z(*half_length_m, *radius_m),
            Shape::Hull { points_m } => {
                let half_m = shape.half_extents_m();
                let points: Vec<Vector> = points_m.iter().map(to_vector).collect();
                // A flat point set has no hull with a volume, so a thin plate replaces it.
                let hull = (half_m.min() > THIN_M)
                    .then(|| SharedShape::convex_hull(&points))
                    .flatten();
                hull.unwrap_or_else(|| cuboid(&half_m.sup(&Vector3::repeat(THIN_M))))
            }
        };
        Some(Self { shape, is_along_y })
    }

    /// The pose of Parry's shape for a pose of the solid.
    pub fn pose(&self, there: Isometry3<f64>) -> Isometry3<f64> {
        if self.is_along_y {
            there * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2)
        } else {
            there
        }
    }
}
