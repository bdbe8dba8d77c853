//! Computes collision shapes and mass properties from the forms and masses that a file states.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::{Body, Form, vector};
use realgap_solid::Shape;
use realgap_solid::ellipsoid;
use realgap_solid::{UniformMass, uniform};

impl Form {
    /// The shape, and the pose of the shape's own frame in the frame of the form.
    pub fn shape(&self) -> (Shape, Isometry3<f64>) {
        let points = match self {
            Self::Box { sides_m } => {
                return (Shape::cuboid(vector(*sides_m) / 2.0), Isometry3::identity());
            }
            Self::Sphere { radius_m } => {
                let radius_m = *radius_m;
                return (Shape::Sphere { radius_m }, Isometry3::identity());
            }
            Self::Cylinder { radius_m, length_m } => {
                let (radius_m, half_length_m) = (*radius_m, length_m / 2.0);
                let shape = Shape::Cylinder {
                    radius_m,
                    half_length_m,
                };
                return (shape, Isometry3::identity());
            }
            Self::Capsule { radius_m, length_m } => {
                let (radius_m, half_length_m) = (*radius_m, length_m / 2.0);
                let shape = Shape::Capsule {
                    radius_m,
                    half_length_m,
                };
                return (shape, Isometry3::identity());
            }
            Self::Ellipsoid { radii_m } => ellipsoid(&vector(*radii_m)),
            Self::Hull { points_m } => points_m.iter().map(|point| vector(*point)).collect(),
        };
        let low = points.iter().fold(points[0], |low, point| low.inf(point));
        let high = points.iter().fold(points[0], |high, point| high.sup(point));
        let middle_m = (low + high) / 2.0;
        let points_m: Arc<[Vector3<f64>]> = points.iter().map(|point| point - middle_m).collect();
        let pose = Isometry3::translation(middle_m.x, middle_m.y, middle_m.z);
        (Shape::Hull { points_m }, pose)
    }
}

impl Body {
    /// Mass (kg), centre of mass (m) and inertia about it (kg m²), in the body's frame; `None` if they have to be computed from
    /// the shapes and there are none with a volume.
    pub fn mass(&self) -> Option<(f64, Vector3<f64>, Matrix3<f64>)> {
        let stated_m = self.centre_of_mass_m.map(vector);
        if let Some(tensor) = &self.inertia_kg_m2 {
            return Some((self.mass_kg, stated_m.unwrap_or_default(), tensor.matrix()));
        }
        if self.mass_kg == 0.0 {
            return Some((0.0, stated_m.unwrap_or_default(), Matrix3::zeros()));
        }
        let (volume_m3, centre_m, inertia_m5) = self.uniform();
        let density_kg_m3 = self.mass_kg / volume_m3;
        (volume_m3 > 0.0).then(|| {
            let centre_m = stated_m.unwrap_or(centre_m);
            (self.mass_kg, centre_m, inertia_m5 * density_kg_m3)
        })
    }

    /// Sum of the volumes of the shapes, m³; overlaps count twice.
    pub fn volume_m3(&self) -> f64 {
        self.uniform().0
    }

    /// Volume (m³), centre (m) and inertia (m⁵) of its shapes at a density of 1.
    fn uniform(&self) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let pieces = self.shapes.iter().filter_map(|piece| {
            let (shape, own) = piece.form.shape();
            Some((uniform(&shape)?.posed(&(piece.pose.isometry() * own)), 1.0))
        });
        UniformMass::together(&pieces.collect::<Vec<_>>())
    }
}
