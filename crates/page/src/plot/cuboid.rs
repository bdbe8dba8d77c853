//! Boxes that stand anyhow, in the view of [`block`](super::block): which hides which, shaded faces, shadows.

use realgap_paint::{Canvas, Point, RGBColor, Stroke};

pub(super) use super::block::project;
use super::block::{darken, view};
use super::colour::INK;

/// A box: its centre, and its three half edges as vectors at right angles, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    /// Its middle.
    pub centre_m: [f64; 3],
    /// From the middle to the middles of three faces.
    pub half_m: [[f64; 3]; 3],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(&b).map(|(a, b)| a * b).sum()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt().max(1e-12);
    v.map(|value| value / length)
}

impl Cuboid {
    /// Its corners: number k has + along axis i where bit i of k is set.
    pub(super) fn corners(&self) -> [[f64; 3]; 8] {
        std::array::from_fn(|corner| self.at([0, 1, 2].map(|axis| sign(corner >> axis & 1 == 1))))
    }

    /// The point at these shares of its half edges.
    fn at(&self, shares: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let along = (0..3).map(|axis| shares[axis] * self.half_m[axis][k]);
            self.centre_m[k] + along.sum::<f64>()
        })
    }

    pub(super) fn is_finite(&self) -> bool {
        let halves = self.half_m.iter().flatten();
        self.centre_m.iter().chain(halves).all(|v| v.is_finite())
    }

    /// The faces that are seen: outward normal, and corners in a circle.
    fn visible(&self) -> impl Iterator<Item = ([f64; 3], [[f64; 3]; 4])> + '_ {
        (0..6).filter_map(|face| {
            let (axis, side) = (face / 2, sign(face % 2 == 1));
            let normal = unit(self.half_m[axis]).map(|v| side * v);
            (dot(normal, view()) > 1e-9).then(|| {
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
                let corner = |(u, v): (f64, f64)| {
                    let mut shares = [side; 3];
                    shares[(axis + 1) % 3] = u;
                    shares[(axis + 2) % 3] = v;
                    self.at(shares)
                };
                (normal, corners.map(corner))
            })
        })
    }

    /// True if there is a plane of either's faces between the two with this one on the far side: then it cannot hide `other`.
    fn is_beyond(&self, other: &Self) -> bool {
        const TOUCH_M: f64 = 1e-4;
        let towards = view();
        let parts = |body: &Self, apart: &Self, far_is_body: bool| {
            (0..6).any(|face| {
                let (axis, side) = (face / 2, sign(face % 2 == 1));
                let normal = unit(body.half_m[axis]).map(|v| side * v);
                let level =
                    dot(normal, body.centre_m) + dot(body.half_m[axis], body.half_m[axis]).sqrt();
                let is_apart = || {
                    apart
                        .corners()
                        .iter()
                        .all(|c| dot(normal, *c) >= level - TOUCH_M)
                };
                // The one outside of the face is nearer if the face is seen.
                let outside_is_near = dot(normal, towards) > 1e-9;
                let outside_is_far = dot(normal, towards) < -1e-9;
                (if far_is_body {
                    outside_is_near
                } else {
                    outside_is_far
                }) && is_apart()
            })
        };
        parts(self, other, true) || parts(other, self, false)
    }
}

fn sign(is_positive: bool) -> f64 {
    if is_positive { 1.0 } else { -1.0 }
}

/// Far boxes first, as far as planes tell; where three hide each other in a circle, or two are in each other, the one whose centre is
/// farthest comes first.
pub(super) fn far_first(cuboids: &[Cuboid]) -> Vec<usize> {
    let nearness = |index: &usize| dot(cuboids[*index].centre_m, view());
    let mut left: Vec<usize> = (0..cuboids.len())
        .filter(|&i| cuboids[i].is_finite())
        .collect();
    left.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
    let beyond = |far: usize| cuboids.iter().map(move |near| cuboids[far].is_beyond(near));
    let beyond: Vec<Vec<bool>> = (0..cuboids.len())
        .map(|far| beyond(far).collect())
        .collect();
    let hides = |near: usize, far: usize| beyond[far][near] && !beyond[near][far];
    let mut order = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let is_free = |candidate: &usize| !left.iter().any(|&other| hides(*candidate, other));
        let free = left.iter().position(is_free);
        order.push(left.remove(free.unwrap_or(0)));
    }
    order
}

/// Draws a box with shaded faces.
pub(super) fn draw_cuboid(
    canvas: &mut Canvas,
    cuboid: &Cuboid,
    place: &impl Fn([f64; 3]) -> Point,
    colour: RGBColor,
) {
    let light = unit([0.15, -0.45, 1.0]);
    for (normal, corners) in cuboid.visible() {
        let share = 0.68 + 0.32 * dot(normal, light).max(0.0);
        let face = corners.map(place);
        canvas.polygon(&face, darken(colour, share));
        canvas.path(&closed(face), Stroke::new(1.1, INK));
    }
}

/// Draws the edges of a box that are seen.
pub(super) fn draw_outline(
    canvas: &mut Canvas,
    cuboid: &Cuboid,
    place: &impl Fn([f64; 3]) -> Point,
    colour: RGBColor,
) {
    for (_, corners) in cuboid.visible().filter(|_| cuboid.is_finite()) {
        canvas.path(&closed(corners.map(place)), Stroke::new(1.5, colour));
    }
}

fn closed(face: [Point; 4]) -> [Point; 5] {
    let [a, b, c, d] = face;
    [a, b, c, d, a]
}

/// Corners of the shadow that light from straight above throws: the hull of the box from above, anticlockwise.
pub(super) fn shadow(cuboid: &Cuboid) -> impl Iterator<Item = [f64; 2]> {
    let mut points = cuboid.corners().map(|[x, y, _]| [x, y]);
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = hull.as_slice() {
                let turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
                if turn > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    lower.into_iter().chain(upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(centre_m: [f64; 3], turn_rad: f64) -> Cuboid {
        let (s, c) = turn_rad.sin_cos();
        Cuboid {
            centre_m,
            half_m: [
                [0.5 * c, 0.5 * s, 0.0],
                [-0.5 * s, 0.5 * c, 0.0],
                [0.0, 0.0, 0.5],
            ],
        }
    }

    fn check_order(cuboids: &[Cuboid]) {
        let order = far_first(cuboids);
        assert_eq!(order.len(), cuboids.len());
        for (rank, &near) in order.iter().enumerate() {
            for &far in &order[rank + 1..] {
                let (a, b) = (&cuboids[near], &cuboids[far]);
                assert!(a.is_beyond(b) || !b.is_beyond(a), "{near} hides {far}");
            }
        }
    }

    #[test]
    fn nothing_is_drawn_before_what_it_hides() {
        let cell = |k: i32| [k % 3, k / 3 % 3, k / 9].map(f64::from);
        let turned = |k| cube(cell(k).map(|v| 1.5 * v), 0.35 * f64::from(k));
        check_order(&(0..27).map(turned).collect::<Vec<_>>());
        // Boxes that touch and lie along the axes, as in a gallery.
        let touching = |k| cube(cell(k), 0.0);
        check_order(&(0..27).map(touching).collect::<Vec<_>>());
    }

    #[test]
    fn what_is_behind_is_beyond() {
        let [x, y, z] = view().map(|v| 2.0 * v);
        let (near, far) = (cube([x, y, z], 0.4), cube([0.0; 3], 0.9));
        assert!(far.is_beyond(&near) && !near.is_beyond(&far));
        assert_eq!(far_first(&[near, far]), [1, 0]);
    }

    #[test]
    fn a_shadow_is_the_hull_from_above() {
        let corners: Vec<[f64; 2]> = shadow(&cube([1.0, 2.0, 9.0], 0.0)).collect();
        assert_eq!(corners, [[0.5, 1.5], [1.5, 1.5], [1.5, 2.5], [0.5, 2.5]]);
        // On its edge a cube has a shadow of six corners at most.
        assert_eq!(shadow(&cube([0.0; 3], 0.3)).count(), 4);
    }
}
