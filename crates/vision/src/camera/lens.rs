//! The lens and the pose of a camera: conversion between pixels and rays.

use super::vector::{Vector, add, cross, dot, less, times, unit};

/// A pinhole with radial distortion: a ray at radius r (1 at 45 degrees) is seen at r (1 + k1 r² + k2 r⁴), as in OpenCV.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Number of columns.
    pub width_px: usize,
    /// Number of rows.
    pub height_px: usize,
    /// Horizontal field of view of the pinhole, radians.
    pub field_of_view_rad: f64,
    /// First and second coefficient of radial distortion.
    pub distortion: [f64; 2],
    /// Standard deviation of the blur, pixels.
    pub blur_px: f64,
}

/// Number of steps of the iteration that inverts the distortion.
const UNDISTORTING: usize = 8;

impl Lens {
    /// The focal length, pixels: distance from the centre to an undistorted ray at 45 degrees.
    pub(crate) fn focal_px(&self) -> f64 {
        0.5 * self.width_px as f64 / (0.5 * self.field_of_view_rad).tan()
    }

    fn stretch(&self, squared: f64) -> f64 {
        1.0 + squared * (self.distortion[0] + squared * self.distortion[1])
    }

    fn centre(&self) -> [f64; 2] {
        [
            0.5 * (self.width_px as f64 - 1.0),
            0.5 * (self.height_px as f64 - 1.0),
        ]
    }

    /// The direction of the ray that is seen at (x, y), as slopes to the right and down for a unit length ahead.
    pub(super) fn slope(&self, x: f64, y: f64) -> [f64; 2] {
        let (focal, centre) = (self.focal_px(), self.centre());
        let seen = [(x - centre[0]) / focal, (y - centre[1]) / focal];
        if self.distortion == [0.0, 0.0] {
            return seen;
        }
        let mut slope = seen;
        for _ in 0..UNDISTORTING {
            let stretch = self.stretch(slope[0] * slope[0] + slope[1] * slope[1]);
            slope = [seen[0] / stretch, seen[1] / stretch];
        }
        slope
    }

    /// Position at which a point is seen, pixels; `None` for a point behind the camera.
    pub fn project_px(&self, pose: &Pose, point_m: [f64; 3]) -> Option<[f64; 2]> {
        let from = less(point_m, pose.place_m);
        let ahead = dot(from, pose.ahead);
        if ahead <= 1e-6 {
            return None;
        }
        let slope = [
            dot(from, pose.right) / ahead,
            dot(from, pose.down()) / ahead,
        ];
        let stretch = self.stretch(slope[0] * slope[0] + slope[1] * slope[1]);
        let (focal, centre) = (self.focal_px(), self.centre());
        Some([0, 1].map(|i| centre[i] + focal * slope[i] * stretch))
    }
}

/// Position and orientation of a camera. A pose from [`Pose::towards`] has no roll, so that its picture is level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Position, metres.
    pub place_m: [f64; 3],
    pub(super) ahead: Vector,
    pub(super) right: Vector,
}

impl Pose {
    /// The pose of a camera that looks at a point; `None` if the point is straight above or below, equal to the position, or not finite.
    pub fn towards(place_m: [f64; 3], look_at_m: [f64; 3]) -> Option<Self> {
        let to = less(look_at_m, place_m);
        let level = to[0].hypot(to[1]);
        let is_somewhere = level > 1e-6 && level.is_finite() && to[2].is_finite();
        if !is_somewhere {
            return None;
        }
        Some(Self {
            place_m,
            ahead: unit(to),
            right: [to[1] / level, -to[0] / level, 0.0],
        })
    }

    pub(super) fn down(&self) -> Vector {
        cross(self.ahead, self.right)
    }

    /// The direction in the room of a ray with these slopes to the right and down.
    pub(super) fn direction(&self, slope: [f64; 2]) -> Vector {
        unit(add(
            self.ahead,
            add(times(self.right, slope[0]), times(self.down(), slope[1])),
        ))
    }

    /// The pose after a translation (metres, in the frame of the room) and rotations (radians) to the right, down, and clockwise about the
    /// line of sight.
    pub fn moved(&self, by_m: Vector, turn_rad: Vector) -> Self {
        let turned = |a: Vector, b: Vector, angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let one = add(times(a, cos), times(b, sin));
            let other = less(times(b, cos), times(a, sin));
            (one, other)
        };
        let (ahead, right) = turned(self.ahead, self.right, turn_rad[0]);
        let down = cross(ahead, right);
        let (ahead, down) = turned(ahead, down, turn_rad[1]);
        let (right, _) = turned(right, down, turn_rad[2]);
        Self {
            place_m: add(self.place_m, by_m),
            ahead,
            right,
        }
    }
}
