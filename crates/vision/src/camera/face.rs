//! The pattern of a die on the faces of a box, which makes its orientation visible.

use super::scene::Block;
use super::vector::Vector;

/// Width of the rim and radius of a dot, as shares of half the shorter side of a face.
const RIM: f64 = 0.1;
const DOT: f64 = 0.16;
/// Distance of dots from the middle, as a share of half the shorter side of a face.
const DOT_DISTANCE: f64 = 0.5;
/// Reflectance of the rim and of dots relative to the rest of the face.
const DARK: f64 = 0.3;

/// Positions of the dots on the face with this number, −1 to 1.
fn dots(number: usize) -> &'static [[i8; 2]] {
    match number {
        1 => &[[0, 0]],
        2 => &[[-1, -1], [1, 1]],
        3 => &[[-1, -1], [0, 0], [1, 1]],
        4 => &[[-1, -1], [-1, 1], [1, -1], [1, 1]],
        5 => &[[-1, -1], [-1, 1], [0, 0], [1, -1], [1, 1]],
        _ => &[[-1, -1], [-1, 0], [-1, 1], [1, -1], [1, 0], [1, 1]],
    }
}

/// Brightness of a die at a point of one of its faces relative to its colour, for rays with this spacing: borders of dark parts are as
/// wide as the spacing, and parts that are smaller than the spacing are replaced by the mean over the face.
pub(super) fn tone(
    block: &Block,
    (axis, is_far): (usize, bool),
    point_m: Vector,
    spacing_m: f64,
) -> f64 {
    let own_m = block.own_m(point_m);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let (at_m, half_m) = ([own_m[i], own_m[j]], [block.half_m[i], block.half_m[j]]);
    let unit_m = half_m[0].min(half_m[1]);
    let (rim_m, dot_m) = (RIM * unit_m, DOT * unit_m);
    let number = if is_far { axis + 1 } else { 6 - axis };
    let dots = dots(number);
    let inside =
        |by_m: f64, size_m: f64| (by_m / spacing_m.min(size_m).max(1e-9) + 0.5).clamp(0.0, 1.0);
    let from_rim_m = (half_m[0] - at_m[0].abs()).min(half_m[1] - at_m[1].abs());
    let to_dot_m = dots.iter().map(|dot| {
        let off = [0, 1].map(|k| at_m[k] - DOT_DISTANCE * unit_m * f64::from(dot[k]));
        off[0].hypot(off[1])
    });
    let to_dot_m = to_dot_m.fold(f64::INFINITY, f64::min);
    let sharp = inside(rim_m - from_rim_m, rim_m).max(inside(dot_m - to_dot_m, dot_m));
    let dot_area = dots.len() as f64 * std::f64::consts::PI * dot_m * dot_m;
    let open = (1.0 - rim_m / half_m[0]) * (1.0 - rim_m / half_m[1]);
    let mean = 1.0 - open + dot_area / (4.0 * half_m[0] * half_m[1]);
    let share = (rim_m / spacing_m.max(1e-9)).min(1.0);
    1.0 - (1.0 - DARK) * (share * sharp + (1.0 - share) * mean)
}
