//! Surfaces in any orientation, in the view of [`block`](super::block): which surface hides which, shaded faces, shadows.

use realgap_drawing::{Canvas, Point, RGBColor, Stroke};
use realgap_robot::morphology::Surface;

use crate::plot::layout::colour::{INK, darken};

/// Azimuth of the viewer from +x, and elevation. They are not 45 degrees, because corners of different cubes would then
/// coincide in the picture.
const AZIMUTH_DEG: f64 = -58.0;
const ELEVATION_DEG: f64 = 27.0;

/// The direction towards the viewer.
pub(in crate::plot) fn view() -> [f64; 3] {
    let (sin_a, cos_a) = AZIMUTH_DEG.to_radians().sin_cos();
    let (sin_e, cos_e) = ELEVATION_DEG.to_radians().sin_cos();
    [cos_a * cos_e, sin_a * cos_e, sin_e]
}

/// The place of a point of a robot in the picture before scaling, in metres to the right and down.
pub(in crate::plot) fn project([x, y, z]: [f64; 3]) -> Point {
    let (sin_a, cos_a) = AZIMUTH_DEG.to_radians().sin_cos();
    let (sin_e, cos_e) = ELEVATION_DEG.to_radians().sin_cos();
    // The viewer is at (cos a cos e, sin a cos e, sin e); right and up are at right angles to that.
    let right = -sin_a * x + cos_a * y;
    let up = -cos_a * sin_e * x - sin_a * sin_e * y + cos_e * z;
    (right, -up)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(&b).map(|(a, b)| a * b).sum()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt().max(1e-12);
    v.map(|value| value / length)
}

/// The cosine of the angle between the normal of a face and the direction towards the viewer.
fn towards(surface: &Surface, face: usize) -> f64 {
    dot(surface.normals[face].into(), view())
}

fn is_seen(surface: &Surface, face: usize) -> bool {
    towards(surface, face) > 1e-9
}

/// True if the plane of a face of either surface separates the two with `far` on the far side: then `far` cannot hide `near`.
fn is_beyond(far: &Surface, near: &Surface) -> bool {
    const TOUCH_M: f64 = 1e-4;
    // A surface outside of a visible face is nearer to the viewer than the body of that face.
    let parts = |body: &Surface, apart: &Surface, side: f64| {
        body.faces.iter().enumerate().any(|(index, face)| {
            let normal = body.normals[index];
            side * towards(body, index) > 1e-9 && {
                let level = normal.dot(&body.corners_m[face.corners[0]]);
                let mut corners = apart.corners_m.iter();
                corners.all(|corner| normal.dot(corner) >= level - TOUCH_M)
            }
        })
    };
    parts(far, near, 1.0) || parts(near, far, -1.0)
}

/// The surfaces in the order in which they are drawn, the farthest first, by the planes that separate them. Where no plane decides
/// (three surfaces hide each other in a circle, or two intersect), the surface with the farthest centre comes first.
pub(in crate::plot) fn far_first(surfaces: &[Surface]) -> Vec<usize> {
    let nearness = |index: &usize| dot(surfaces[*index].centre_m.into(), view());
    let all = 0..surfaces.len();
    let mut left: Vec<usize> = all.filter(|&i| surfaces[i].is_finite()).collect();
    left.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
    let rows = surfaces.iter().map(|far| {
        let near = surfaces.iter();
        near.map(|near| is_beyond(far, near)).collect()
    });
    let beyond: Vec<Vec<bool>> = rows.collect();
    let hides = |near: usize, far: usize| beyond[far][near] && !beyond[near][far];
    let mut order = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let is_free = |candidate: &usize| !left.iter().any(|&other| hides(*candidate, other));
        let free = left.iter().position(is_free);
        order.push(left.remove(free.unwrap_or(0)));
    }
    order
}

/// Draws a surface with shaded faces, its edges in ink; `place` takes a point in the world to the picture.
pub(in crate::plot) fn draw_surface(
    canvas: &mut Canvas,
    surface: &Surface,
    place: &impl Fn([f64; 3]) -> Point,
    colour: RGBColor,
    line: f64,
) {
    let light = unit([0.15, -0.45, 1.0]);
    let is_rounded = surface.faces.len() > 6;
    if is_rounded {
        // One polygon below all faces leaves no seams between the small faces.
        let all = surface.corners_m.iter();
        let all = all.map(|corner| place((*corner).into()).into());
        let all: Vec<Point> = hull(all.collect()).into_iter().map(Point::from).collect();
        canvas.polygon(&all, darken(colour, 0.84));
    }
    for index in (0..surface.faces.len()).filter(|index| is_seen(surface, *index)) {
        let share = 0.68 + 0.32 * dot(surface.normals[index].into(), light).max(0.0);
        canvas.polygon(&corners(surface, index, place), darken(colour, share));
        draw_edges(canvas, surface, index, place, Stroke::new(line, INK));
    }
}

/// Draws the edges of a surface that are seen.
pub(in crate::plot) fn draw_outline(
    canvas: &mut Canvas,
    surface: &Surface,
    place: &impl Fn([f64; 3]) -> Point,
    colour: RGBColor,
) {
    let faces = 0..surface.faces.len();
    for index in faces.filter(|index| surface.is_finite() && is_seen(surface, *index)) {
        draw_edges(canvas, surface, index, place, Stroke::new(1.5, colour));
    }
}

fn corners(surface: &Surface, face: usize, place: &impl Fn([f64; 3]) -> Point) -> Vec<Point> {
    let corners = surface.faces[face].corners.iter();
    let places = corners.map(|&corner| place(surface.corners_m[corner].into()));
    places.collect()
}

/// The edges of a face where another meets it at an angle, and where the surface ends.
fn draw_edges(
    canvas: &mut Canvas,
    surface: &Surface,
    face: usize,
    place: &impl Fn([f64; 3]) -> Point,
    stroke: Stroke,
) {
    let mut circle = corners(surface, face, place);
    circle.extend(circle.first().copied());
    let beside = &surface.faces[face].beside;
    let is_drawn = |beside: &usize| surface.is_sharp(face, *beside) || !is_seen(surface, *beside);
    if beside.iter().all(is_drawn) {
        return canvas.path(&circle, stroke);
    }
    let edges = beside.iter().enumerate();
    for (edge, _) in edges.filter(|(_, beside)| is_drawn(beside)) {
        canvas.path(&circle[edge..edge + 2], stroke);
    }
}

/// Corners of the shadow under light from straight above, anticlockwise.
pub(in crate::plot) fn shadow(surface: &Surface) -> Vec<[f64; 2]> {
    hull(surface.corners_m.iter().map(|p| [p.x, p.y]).collect())
}

/// The corners of the hull of points in a plane, anticlockwise.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
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
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Vector3};
    use realgap_robot::morphology::Shape;

    use super::*;

    fn cube(centre_m: [f64; 3], turn_rad: f64) -> Surface {
        let pose = Isometry3::new(centre_m.into(), turn_rad * Vector3::z());
        Surface::cuboid(Vector3::repeat(0.5)).placed(&pose)
    }

    fn check_order(surfaces: &[Surface]) {
        let order = far_first(surfaces);
        assert_eq!(order.len(), surfaces.len());
        for (rank, &near) in order.iter().enumerate() {
            for &far in &order[rank + 1..] {
                let (a, b) = (&surfaces[near], &surfaces[far]);
                assert!(is_beyond(a, b) || !is_beyond(b, a), "{near} hides {far}");
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
        let ball = Shape::Sphere { radius_m: 0.5 }.surface().unwrap();
        let balls = |k: i32| match k % 2 {
            0 => ball.placed(&Isometry3::new(cell(k).into(), Vector3::zeros())),
            _ => cube(cell(k), 0.0),
        };
        check_order(&(0..27).map(balls).collect::<Vec<_>>());
    }

    #[test]
    fn what_is_behind_is_beyond() {
        let [x, y, z] = view().map(|v| 2.0 * v);
        let (near, far) = (cube([x, y, z], 0.4), cube([0.0; 3], 0.9));
        assert!(is_beyond(&far, &near) && !is_beyond(&near, &far));
        assert_eq!(far_first(&[near, far]), [1, 0]);
    }

    #[test]
    fn a_shadow_is_the_hull_from_above() {
        let corners = shadow(&cube([1.0, 2.0, 9.0], 0.0));
        assert_eq!(corners, [[0.5, 1.5], [1.5, 1.5], [1.5, 2.5], [0.5, 2.5]]);
        // On its edge a cube has a shadow of six corners at most.
        assert_eq!(shadow(&cube([0.0; 3], 0.3)).len(), 4);
    }
}
