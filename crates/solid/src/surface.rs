//! Surfaces of shapes as polygons with flat faces, for drawing.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::hull::convex_hull;
use crate::shape::Shape;

/// The number of corners of a polygon that represents a circle.
const ROUND: usize = 24;
/// Cosine of 35°: neighbouring faces whose normals differ by less belong to one rounded surface.
const SHARP_COS: f64 = 0.82;

/// A flat face of a [`Surface`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Facet {
    /// The indices of its corners, anticlockwise as seen from outside.
    pub corners: Vec<usize>,
    /// For each corner, the index of the face on the other side of the edge from this corner to the next.
    pub beside: Vec<usize>,
}

/// A convex surface of flat faces; circles are polygons with 24 corners. All lengths are in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Position of the centre.
    pub centre_m: Vector3<f64>,
    /// Positions of the corners.
    pub corners_m: Vec<Vector3<f64>>,
    /// The faces.
    pub faces: Arc<[Facet]>,
    /// The outward unit normal of every face.
    pub normals: Vec<Vector3<f64>>,
}

impl Surface {
    /// A surface around the origin from its corners, its faces and their normals.
    fn new(corners_m: Vec<Vector3<f64>>, faces: Vec<(Vec<usize>, Vector3<f64>)>) -> Self {
        let mut owner = HashMap::new();
        for (index, (corners, _)) in faces.iter().enumerate() {
            for edge in edges(corners) {
                owner.insert(edge, index);
            }
        }
        let face = |(index, (corners, _)): (usize, &(Vec<usize>, Vector3<f64>))| Facet {
            beside: edges(corners)
                .map(|(a, b)| owner.get(&(b, a)).copied().unwrap_or(index))
                .collect(),
            corners: corners.clone(),
        };
        Self {
            centre_m: Vector3::zeros(),
            faces: faces.iter().enumerate().map(face).collect(),
            normals: faces.into_iter().map(|(_, normal)| normal).collect(),
            corners_m,
        }
    }

    /// A box along the axes. The faces come in pairs for the axes x, y and z; the face at the smaller coordinate comes first.
    pub fn cuboid(half_extents_m: Vector3<f64>) -> Self {
        let sign = |is_positive: bool| if is_positive { 1.0 } else { -1.0 };
        let corner = |number: usize| {
            let along = [0, 1, 2].map(|axis| sign(number >> axis & 1 == 1));
            half_extents_m.component_mul(&Vector3::from(along))
        };
        let face = |number: usize| {
            let (axis, is_far) = (number / 2, number % 2 == 1);
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let first = usize::from(is_far) << axis;
            let mut corners = vec![first, first | u, first | u | v, first | v];
            if !is_far {
                corners[1..].reverse();
            }
            let mut normal = Vector3::zeros();
            normal[axis] = sign(is_far);
            (corners, normal)
        };
        Self::new((0..8).map(corner).collect(), (0..6).map(face).collect())
    }

    /// A surface from faces that are given by their corners; faces without an area are left out.
    fn of_faces(corners_m: Vec<Vector3<f64>>, faces: Vec<Vec<usize>>) -> Self {
        let faces = faces.into_iter().filter_map(|face| {
            // Newell's method, which is correct for any flat face.
            let area: Vector3<f64> = (edges(&face))
                .map(|(a, b)| corners_m[a].cross(&corners_m[b]))
                .sum();
            Some((face, area.try_normalize(f64::MIN_POSITIVE)?))
        });
        let faces = faces.collect();
        Self::new(corners_m, faces)
    }

    /// The surface of revolution of a profile around the z axis: pairs of radius and height, from the lowest point upwards. An end of the
    /// profile that is not on the axis gets a flat face.
    fn revolved(profile_m: &[[f64; 2]]) -> Self {
        let mut corners_m = Vec::new();
        let mut rings: Vec<Vec<usize>> = Vec::new();
        for &[radius_m, z_m] in profile_m {
            let first = corners_m.len();
            let count = if radius_m > 0.0 { ROUND } else { 1 };
            corners_m.extend((0..count).map(|k| {
                let (sin, cos) = (TAU * k as f64 / ROUND as f64).sin_cos();
                Vector3::new(radius_m * cos, radius_m * sin, z_m)
            }));
            rings.push((0..ROUND).map(|k| first + k % count).collect());
        }
        let mut faces = Vec::new();
        for pair in rings.windows(2) {
            let (low, high) = (&pair[0], &pair[1]);
            faces.extend((0..ROUND).map(|k| {
                let next = (k + 1) % ROUND;
                let mut face = vec![low[k], low[next], high[next], high[k]];
                face.dedup();
                if face.first() == face.last() {
                    face.pop();
                }
                face
            }));
        }
        if let [lowest, .., highest] = rings.as_slice() {
            let is_flat = |ring: &[usize]| ring[0] != ring[1];
            if is_flat(lowest) {
                faces.push(lowest.iter().rev().copied().collect());
            }
            if is_flat(highest) {
                faces.push(highest.clone());
            }
        }
        Self::of_faces(corners_m, faces)
    }

    /// The same surface after its frame was moved to this pose.
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        let point = |p: &Vector3<f64>| (pose * Point3::from(*p)).coords;
        Self {
            centre_m: point(&self.centre_m),
            corners_m: self.corners_m.iter().map(point).collect(),
            faces: Arc::clone(&self.faces),
            normals: self.normals.iter().map(|n| pose.rotation * n).collect(),
        }
    }

    /// True if all coordinates of the corners are finite.
    pub fn is_finite(&self) -> bool {
        self.corners_m.iter().flatten().all(|v| v.is_finite())
    }

    /// The faces divided into triangles: the index of the face, and the indices of three corners.
    pub fn triangles(&self) -> impl Iterator<Item = (usize, [usize; 3])> + '_ {
        self.faces.iter().enumerate().flat_map(|(index, face)| {
            let pairs = face.corners[1..].windows(2);
            pairs.map(move |pair| (index, [face.corners[0], pair[0], pair[1]]))
        })
    }

    /// The shading normal of a face of a rounded surface at one of its corners: the mean normal, weighted by area, of the faces that meet at
    /// this corner and do not form a sharp edge with the face.
    pub fn rounded_normal(&self, face: usize, corner: usize) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (other, facet) in self.faces.iter().enumerate() {
            if facet.corners.contains(&corner) && !self.is_sharp(face, other) {
                let point = |k: usize| self.corners_m[k] - self.centre_m;
                let area = edges(&facet.corners).map(|(a, b)| point(a).cross(&point(b)));
                sum += area.sum::<Vector3<f64>>();
            }
        }
        sum.try_normalize(0.0).unwrap_or(self.normals[face])
    }

    /// True if two faces meet at a sharp edge, which is drawn.
    pub fn is_sharp(&self, face: usize, beside: usize) -> bool {
        self.normals[face].dot(&self.normals[beside]) < SHARP_COS
    }
}

fn edges(corners: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let next = corners.iter().skip(1).chain(corners.first());
    corners.iter().copied().zip(next.copied())
}

/// Points on a quarter of the unit circle, as cosine and sine, from the lowest point to the side.
fn quarter() -> impl DoubleEndedIterator<Item = [f64; 2]> {
    const STEPS: usize = ROUND / 4;
    (0..=STEPS).map(|k| match k {
        0 => [0.0, -1.0],
        _ => {
            let (sin, cos) = (FRAC_PI_2 * (k as f64 / STEPS as f64 - 1.0)).sin_cos();
            [cos, sin]
        }
    })
}

impl Shape {
    /// The surface of the shape around the origin of its own frame; `None` if it has none. The surface of a hull of points on a line is the
    /// box around them.
    pub fn surface(&self) -> Option<Surface> {
        let rounded = |radius_m: f64, half_length_m: f64| {
            let low = quarter().map(|[cos, sin]| [radius_m * cos, radius_m * sin - half_length_m]);
            let high = quarter()
                .rev()
                .map(|[cos, sin]| [radius_m * cos, half_length_m - radius_m * sin]);
            // The two halves of a sphere share the circle at their sides, so it is taken only once.
            let high = high.skip(usize::from(half_length_m == 0.0));
            Surface::revolved(&low.chain(high).collect::<Vec<_>>())
        };
        match self {
            Self::Box { half_extents_m } => Some(Surface::cuboid(*half_extents_m)),
            Self::Sphere { radius_m } => Some(rounded(*radius_m, 0.0)),
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => Some(Surface::revolved(&[
                [*radius_m, -half_length_m],
                [*radius_m, *half_length_m],
            ])),
            Self::Capsule {
                radius_m,
                half_length_m,
            } => Some(rounded(*radius_m, *half_length_m)),
            Self::Hull { points_m } => {
                let hull = convex_hull(points_m).map(|(corners_m, triangles)| {
                    let faces = triangles.iter().map(|triangle| triangle.to_vec());
                    Surface::of_faces(corners_m, faces.collect())
                });
                let hull = hull.filter(|hull| !hull.faces.is_empty());
                Some(hull.unwrap_or_else(|| Surface::cuboid(self.half_extents_m())))
            }
            Self::Nothing => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Shape> {
        let corners = [
            [1.0, 0.0, 0.2],
            [-1.0, 0.3, -0.2],
            [0.0, -0.3, 0.0],
            [0.1, 0.2, 0.7],
            [0.0, 0.1, -0.7],
        ];
        vec![
            Shape::cuboid(Vector3::new(0.1, 0.2, 0.3)),
            Shape::Sphere { radius_m: 0.4 },
            Shape::Cylinder {
                radius_m: 0.1,
                half_length_m: 0.5,
            },
            Shape::Capsule {
                radius_m: 0.1,
                half_length_m: 0.5,
            },
            Shape::Hull {
                points_m: corners.map(Vector3::from).into(),
            },
        ]
    }

    #[test]
    fn surfaces_are_closed_and_convex_with_outward_normals() {
        for shape in shapes() {
            let surface = shape.surface().unwrap();
            for (index, face) in surface.faces.iter().enumerate() {
                let normal = &surface.normals[index];
                let level_m = normal.dot(&surface.corners_m[face.corners[0]]);
                assert!(level_m > 0.0, "{shape:?} {index}");
                let highest_m = surface
                    .corners_m
                    .iter()
                    .map(|p| p.dot(normal))
                    .fold(0.0, f64::max);
                assert!(highest_m - level_m < 1e-9, "{shape:?} {index}");
                for (&beside, (a, b)) in face.beside.iter().zip(edges(&face.corners)) {
                    assert_ne!(beside, index, "{shape:?}");
                    assert!(edges(&surface.faces[beside].corners).any(|edge| edge == (b, a)));
                }
            }
            // Polygons reach less than 1 % less far than the round shapes.
            let half_m = shape.half_extents_m();
            for axis in 0..3 {
                let reach_m = surface
                    .corners_m
                    .iter()
                    .map(|p| p[axis])
                    .fold(0.0, f64::max);
                assert!(
                    (reach_m - half_m[axis]).abs() < 1e-2 * half_m[axis],
                    "{shape:?} {axis}"
                );
            }
        }
    }

    #[test]
    fn cylinders_have_sharp_edges_and_balls_have_none() {
        let sharp = |shape: &Shape| {
            let surface = shape.surface().unwrap();
            let faces = surface.faces.iter().enumerate();
            let edges =
                faces.flat_map(|(index, face)| face.beside.iter().map(move |b| (index, *b)));
            edges.filter(|(a, b)| surface.is_sharp(*a, *b)).count()
        };
        let counts: Vec<usize> = shapes()[..4].iter().map(sharp).collect();
        assert_eq!(counts, [24, 0, 4 * ROUND, 0]);
    }

    #[test]
    fn a_flat_hull_has_two_sides_and_a_thin_one_is_shown_as_a_box() {
        let faces = |corners: [[f64; 3]; 3]| {
            let points_m = corners.map(Vector3::from).into();
            Shape::Hull { points_m }.surface().unwrap().faces.len()
        };
        let flat = [[0.1, 0.1, 0.0], [-0.1, 0.1, 0.0], [0.0, -0.1, 0.0]];
        assert_eq!(faces(flat), 2);
        assert_eq!(faces([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0; 3]]), 6);
        assert_eq!(Shape::Nothing.surface(), None);
    }
}
