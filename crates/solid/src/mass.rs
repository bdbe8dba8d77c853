//! Mass properties of shapes with uniform density.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::hull::convex_hull;
use crate::shape::Shape;

/// Volume, centre of mass, and inertia per density of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformMass {
    /// Volume, m³.
    pub volume_m3: f64,
    /// Centre of mass in the shape's frame, metres.
    pub centre_m: Vector3<f64>,
    /// Inertia about the centre of mass per density, m⁵.
    pub inertia_m5: Matrix3<f64>,
}

impl UniformMass {
    /// The same properties in the frame in which the shape has this pose.
    #[must_use]
    pub fn posed(&self, pose: &Isometry3<f64>) -> Self {
        let turn = pose.rotation.to_rotation_matrix();
        Self {
            volume_m3: self.volume_m3,
            centre_m: (pose * Point3::from(self.centre_m)).coords,
            inertia_m5: turn * self.inertia_m5 * turn.transpose(),
        }
    }

    /// The combined mass (kg), centre of mass (m) and inertia about it (kg m²) of several pieces, each with its own density (kg/m³).
    pub fn together(pieces: &[(Self, f64)]) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let mass_kg: f64 = pieces.iter().map(|(one, rho)| one.volume_m3 * rho).sum();
        if mass_kg <= 0.0 {
            return (0.0, Vector3::zeros(), Matrix3::zeros());
        }
        let moment: Vector3<f64> = pieces
            .iter()
            .map(|(one, rho)| one.centre_m * (one.volume_m3 * rho))
            .sum();
        let centre_m = moment / mass_kg;
        let inertia = pieces.iter().map(|(one, rho)| {
            let d = one.centre_m - centre_m;
            let away = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            (one.inertia_m5 + away * one.volume_m3) * *rho
        });
        (mass_kg, centre_m, inertia.sum())
    }
}

/// The mass properties of a shape with uniform density; `None` for a shape without volume.
pub fn uniform(shape: &Shape) -> Option<UniformMass> {
    use std::f64::consts::PI;
    let diagonal = |x: f64, y: f64, z: f64| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let about_centre = |volume_m3: f64, inertia_m5| UniformMass {
        volume_m3,
        centre_m: Vector3::zeros(),
        inertia_m5,
    };
    let mass = match shape {
        Shape::Box { half_extents_m } => {
            let v = 8.0 * half_extents_m.product();
            let s = half_extents_m.component_mul(half_extents_m) * (v / 3.0);
            about_centre(v, diagonal(s.y + s.z, s.x + s.z, s.x + s.y))
        }
        Shape::Sphere { radius_m } => {
            let v = 4.0 / 3.0 * PI * radius_m.powi(3);
            about_centre(
                v,
                Matrix3::from_diagonal_element(0.4 * v * radius_m * radius_m),
            )
        }
        Shape::Cylinder {
            radius_m,
            half_length_m,
        } => {
            let v = 2.0 * PI * radius_m * radius_m * half_length_m;
            let across = v * (radius_m * radius_m / 4.0 + half_length_m * half_length_m / 3.0);
            about_centre(v, diagonal(across, across, v * radius_m * radius_m / 2.0))
        }
        Shape::Capsule {
            radius_m: r,
            half_length_m: h,
        } => {
            // A cylinder and two half balls; the centre of mass of a half ball is 3/8 of the radius away from its flat side.
            let (tube, ball) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
            let across =
                tube * (r * r / 4.0 + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
            let along = tube * r * r / 2.0 + ball * 0.4 * r * r;
            about_centre(tube + ball, diagonal(across, across, along))
        }
        Shape::Hull { points_m } => {
            let (corners, triangles) = convex_hull(points_m)?;
            enclosed(&corners, &triangles)
        }
        Shape::Nothing => return None,
    };
    (mass.volume_m3 > 0.0).then_some(mass)
}

/// The mass of the volume that triangles enclose: the sum over the tetrahedra between each triangle and one point. (The inertia that
/// Parry computes from a hull has wrong products in bodies without symmetry.)
fn enclosed(corners: &[Vector3<f64>], triangles: &[[usize; 3]]) -> UniformMass {
    let apex: Vector3<f64> = corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
    let (mut volume_m3, mut moment, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| corners[corner] - apex);
        let part = a.dot(&b.cross(&c)) / 6.0;
        let sum = a + b + c;
        volume_m3 += part;
        moment += sum * (part / 4.0);
        let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
        second += (squares + sum * sum.transpose()) * (part / 20.0);
    }
    let away = moment / volume_m3;
    let second = second - away * away.transpose() * volume_m3;
    UniformMass {
        volume_m3,
        centre_m: apex + away,
        inertia_m5: Matrix3::identity() * second.trace() - second,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_the_corners_of_a_box_has_the_mass_of_the_box() {
        let half = Vector3::new(0.1, 0.2, 0.3);
        let corners = (0..8).map(|k| {
            let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            Vector3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
        });
        let hull = uniform(&Shape::Hull {
            points_m: corners.collect(),
        })
        .unwrap();
        let cuboid = uniform(&Shape::cuboid(half)).unwrap();
        assert!((hull.volume_m3 / cuboid.volume_m3 - 1.0).abs() < 1e-9);
        assert!((hull.inertia_m5 - cuboid.inertia_m5).amax() < 1e-9 * cuboid.inertia_m5.amax());
    }

    #[test]
    fn a_hull_without_symmetry_has_the_products_of_inertia_of_a_tetrahedron() {
        let corners = [
            Vector3::zeros(),
            Vector3::new(0.3, 0.0, 0.0),
            Vector3::new(0.0, 0.2, 0.0),
            Vector3::new(0.0, 0.0, 0.1),
        ];
        let hull = uniform(&Shape::Hull {
            points_m: corners.into(),
        })
        .unwrap();
        // About the centre of mass the integral of x y is minus the product of the edges times V / 80, and that of x² is 3 a² V / 80.
        let volume_m3 = 0.3 * 0.2 * 0.1 / 6.0;
        assert!((hull.volume_m3 - volume_m3).abs() < 1e-15);
        assert!((hull.centre_m - Vector3::new(0.075, 0.05, 0.025)).amax() < 1e-15);
        let xy = 0.3 * 0.2 * volume_m3 / 80.0;
        let zz = 3.0 * (0.09 + 0.04) * volume_m3 / 80.0;
        assert!(
            (hull.inertia_m5[(0, 1)] - xy).abs() < 1e-18,
            "{}",
            hull.inertia_m5
        );
        assert!((hull.inertia_m5[(2, 2)] - zz).abs() < 1e-18);
    }

    #[test]
    fn a_capsule_without_length_is_a_ball() {
        let capsule = Shape::Capsule {
            radius_m: 0.2,
            half_length_m: 0.0,
        };
        let (a, b) = (
            uniform(&capsule).unwrap(),
            uniform(&Shape::Sphere { radius_m: 0.2 }).unwrap(),
        );
        assert!((a.inertia_m5 - b.inertia_m5).amax() < 1e-15);
    }
}
