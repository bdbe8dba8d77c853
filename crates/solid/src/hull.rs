//! Convex hulls of points: hulls of ellipsoids, and hulls of meshes reduced to few corners.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as Placed, Rotation, Vector};
use parry3d_f64::shape::SharedShape;

use crate::shape::Shape;

/// The largest number of corners of a hull that is made from a mesh.
pub const MAX_CORNERS: usize = 64;
/// The number of directions in which the farthest corner of a mesh is kept.
const DIRECTIONS: usize = 60;
/// The number of directions in which the reduced hull is compared with the whole hull.
const CHECKS: usize = 500;

/// Unit vectors spread evenly over all directions (a Fibonacci spiral).
fn directions(count: usize) -> impl Iterator<Item = Vector3<f64>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let turn = golden * k as f64;
        let radius = (1.0 - z * z).sqrt();
        Vector3::new(radius * turn.cos(), radius * turn.sin(), z)
    })
}

/// For each direction, the index of the point that lies farthest along it, and its distance. The points are read in a single pass,
/// because a mesh of a million triangles does not fit into the cache of a processor.
fn farthest(points: &[Vector3<f64>], directions: &[Vector3<f64>]) -> Vec<(usize, f64)> {
    let mut found = vec![(0, f64::NEG_INFINITY); directions.len()];
    for (index, point) in points.iter().enumerate() {
        for (direction, far) in directions.iter().zip(&mut found) {
            let along = point.dot(direction);
            if along.total_cmp(&far.1).is_ge() {
                *far = (index, along);
            }
        }
    }
    found
}

/// The lowest and the highest corner of the axis-aligned box around points; zero for no points.
pub fn bounds(points: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold([first; 2], |[low, high], point| {
        [low.inf(point), high.sup(point)]
    })
}

/// At most [`MAX_CORNERS`] of the points, chosen so that their hull is nearly the hull of all points; and the largest distance by which the
/// hull of all points reaches beyond theirs, metres.
pub fn simplified(points: &[Vector3<f64>]) -> (Vec<Vector3<f64>>, f64) {
    if points.len() <= MAX_CORNERS {
        return (points.to_vec(), 0.0);
    }
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    // The axes come first, so that the reduced hull has the same axis-aligned box as all points.
    let axes = axes.into_iter().flat_map(|axis| [axis, -axis]);
    let mut kept: Vec<usize> = Vec::new();
    let looked: Vec<_> = axes.chain(directions(DIRECTIONS)).collect();
    for (index, _) in farthest(points, &looked) {
        if !kept.contains(&index) {
            kept.push(index);
        }
    }
    kept.truncate(MAX_CORNERS);
    let corners: Vec<Vector3<f64>> = kept.iter().map(|&index| points[index]).collect();
    let checks: Vec<_> = directions(CHECKS).collect();
    let (whole, own) = (farthest(points, &checks), farthest(&corners, &checks));
    let beyond_m = whole.iter().zip(&own).map(|(whole, own)| whole.1 - own.1);
    (corners, beyond_m.fold(0.0, f64::max))
}

/// A shape at a pose as a shape of Parry; `None` for a shape without a surface, or a hull that cannot be built.
pub fn solid_surface(shape: &Shape, pose: &Isometry3<f64>) -> Option<(Placed, SharedShape)> {
    let vector = |v: &Vector3<f64>| Vector::new(v.x, v.y, v.z);
    let mut pose = *pose;
    let surface = match shape {
        Shape::Nothing => return None,
        Shape::Box { half_extents_m: h } => SharedShape::cuboid(h.x, h.y, h.z),
        Shape::Sphere { radius_m } => SharedShape::ball(*radius_m),
        Shape::Cylinder {
            radius_m,
            half_length_m,
        } => {
            // The axis of Parry's cylinders is y.
            let turn = std::f64::consts::FRAC_PI_2;
            pose *= UnitQuaternion::from_axis_angle(&Vector3::x_axis(), turn);
            SharedShape::cylinder(*half_length_m, *radius_m)
        }
        Shape::Capsule {
            radius_m,
            half_length_m,
        } => SharedShape::capsule_z(*half_length_m, *radius_m),
        Shape::Hull { points_m } => {
            let points: Vec<Vector> = points_m.iter().map(vector).collect();
            SharedShape::convex_hull(&points)?
        }
    };
    let q = pose.rotation;
    let placed = Placed::from_parts(
        vector(&pose.translation.vector),
        Rotation::from_xyzw(q.i, q.j, q.k, q.w),
    );
    Some((placed, surface))
}

/// Corners, and triangles as indices of corners.
type Triangles = (Vec<Vector3<f64>>, Vec<[usize; 3]>);

/// The corners and the triangles of the convex hull of points; the corners of a triangle are anticlockwise as seen from outside. `None` for
/// points on a line.
pub fn convex_hull(points_m: &[Vector3<f64>]) -> Option<Triangles> {
    let points: Vec<Vector> = points_m
        .iter()
        .map(|p| Vector::new(p.x, p.y, p.z))
        .collect();
    let (corners, triangles) = parry3d_f64::transformation::try_convex_hull(&points).ok()?;
    let corners = corners.iter().map(|p| Vector3::new(p.x, p.y, p.z));
    let triangles = triangles.into_iter().map(|t| t.map(|k| k as usize));
    Some((corners.collect(), triangles.collect()))
}

/// Points spread over the surface of an ellipsoid with these radii.
pub fn ellipsoid(radii_m: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let axes = axes.into_iter().flat_map(|axis| [axis, -axis]);
    let points = axes.chain(directions(MAX_CORNERS - 6));
    points.map(|point| point.component_mul(radii_m)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_that_is_reduced_to_few_points_keeps_its_size() {
        let points: Vec<_> = directions(5000).collect();
        let (corners, beyond_m) = simplified(&points);
        assert!(corners.len() <= MAX_CORNERS);
        assert!((0.0..0.2).contains(&beyond_m), "{beyond_m}");
    }
}
