//! The shapes that a solid can have: box, sphere, cylinder, capsule and convex hull, each in its own frame.

use std::sync::Arc;

use nalgebra::Vector3;

/// The surface of a solid, about the origin of the solid's frame and along its axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A box.
    Box {
        /// Half the lengths of the edges along x, y and z, metres.
        half_extents_m: Vector3<f64>,
    },
    /// A ball.
    Sphere {
        /// Radius, metres.
        radius_m: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, metres.
        radius_m: f64,
        /// Half of the length, metres.
        half_length_m: f64,
    },
    /// A cylinder along z with half a ball on either end.
    Capsule {
        /// Radius, metres.
        radius_m: f64,
        /// Half of the length between the centres of the balls, metres.
        half_length_m: f64,
    },
    /// The convex hull of points; meshes and ellipsoids are represented by it.
    Hull {
        /// The corners, metres; the axis-aligned box around them has its centre at the origin.
        points_m: Arc<[Vector3<f64>]>,
    },
    /// No surface at all: a solid that has mass only.
    Nothing,
}

impl Shape {
    /// A box of these half extents.
    pub const fn cuboid(half_extents_m: Vector3<f64>) -> Self {
        Self::Box { half_extents_m }
    }

    /// Half extents of the bounding box along the shape's own axes, metres.
    pub fn half_extents_m(&self) -> Vector3<f64> {
        match self {
            Self::Box { half_extents_m } => *half_extents_m,
            Self::Sphere { radius_m } => Vector3::repeat(*radius_m),
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => Vector3::new(*radius_m, *radius_m, *half_length_m),
            Self::Capsule {
                radius_m,
                half_length_m,
            } => Vector3::new(*radius_m, *radius_m, half_length_m + radius_m),
            Self::Hull { points_m } => points_m
                .iter()
                .fold(Vector3::zeros(), |most, point| most.sup(&point.abs())),
            Self::Nothing => Vector3::zeros(),
        }
    }

    /// The largest distance that the shape reaches from its origin along a unit vector of its own frame (the support function), metres.
    pub fn reach_m(&self, direction: &Vector3<f64>) -> f64 {
        match self {
            Self::Box { half_extents_m } => direction.abs().dot(half_extents_m),
            Self::Sphere { radius_m } => *radius_m,
            Self::Cylinder {
                radius_m,
                half_length_m,
            } => radius_m * direction.xy().norm() + half_length_m * direction.z.abs(),
            Self::Capsule {
                radius_m,
                half_length_m,
            } => radius_m + half_length_m * direction.z.abs(),
            Self::Hull { points_m } => points_m
                .iter()
                .map(|point| point.dot(direction))
                .fold(f64::NEG_INFINITY, f64::max),
            Self::Nothing => 0.0,
        }
    }

    /// True for a box, the shape of which modules are made.
    pub const fn is_box(&self) -> bool {
        matches!(self, Self::Box { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounding_box_agrees_with_the_reach_along_the_axes() {
        let corners = [[1.0, 0.0, 0.2], [-1.0, 0.3, -0.2], [0.0, -0.3, 0.0]];
        for shape in [
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
            Shape::Nothing,
        ] {
            let half_m = shape.half_extents_m();
            for (axis, unit) in [Vector3::x(), Vector3::y(), Vector3::z()]
                .iter()
                .enumerate()
            {
                for direction in [*unit, -unit] {
                    let reach_m = shape.reach_m(&direction);
                    assert!((reach_m - half_m[axis]).abs() < 1e-12, "{shape:?} {axis}");
                }
            }
        }
    }
}
