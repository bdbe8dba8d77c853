//! Boxes of robots seen from the side and above, in parallel projection: shaded faces, the farthest box drawn first.

use nalgebra::Isometry3;

use super::surface::{draw_surface, far_first, project, shadow, view};
use crate::plot::kit::*;
use realgap_core::statistics::ends_of;
use realgap_robot::morphology::Surface;

/// What a block stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BlockKind {
    /// A cube without a servo.
    Passive,
    /// A cube with a servo.
    Active,
    /// The plate that a servo spins.
    Plate,
    /// A body that no servo moves.
    Body,
    /// A body at a joint that a servo moves.
    DrivenBody,
}

/// How a driven face moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// About its own normal.
    Spin,
    /// Like a hinge.
    Bend,
}

/// The driven face of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DrivenFace {
    /// 0, 1 or 2: the axis of its normal.
    pub axis: usize,
    /// Whether it looks towards larger coordinates.
    pub positive: bool,
    /// How it moves.
    pub motion: Motion,
}

/// A piece of a robot, in metres, z up: a box along the axes, or a surface inside of such a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Lower corner.
    pub lower_m: [f64; 3],
    /// Upper corner.
    pub upper_m: [f64; 3],
    /// What it stands for.
    pub kind: BlockKind,
    /// The driven face, if the block has one. Of a plate it is the side on which the plate turns against its cube.
    pub driven: Option<DrivenFace>,
    /// Its surface, unless it is the box itself.
    pub surface: Option<Surface>,
}

pub(in crate::plot) const PASSIVE: RGBColor = RGBColor(226, 221, 211);
pub(in crate::plot) const ACTIVE: RGBColor = RGBColor(120, 178, 216);
pub(in crate::plot) const SPIN: RGBColor = VERMILLION;
pub(in crate::plot) const BEND: RGBColor = RGBColor(240, 228, 66);
pub(in crate::plot) const FLOOR: RGBColor = RGBColor(243, 243, 241);
const SHADOW: RGBColor = RGBColor(214, 214, 211);

/// The visible face of each axis: towards +x, −y and +z.
const VISIBLE_POSITIVE: [bool; 3] = [true, false, true];
/// How bright a face of each axis is.
const BRIGHTNESS: [f64; 3] = [0.72, 0.88, 1.0];

impl Block {
    /// Its surface, also of a box.
    fn surface(&self) -> Surface {
        self.surface.clone().unwrap_or_else(|| {
            let half = |axis: usize| 0.5 * (self.upper_m[axis] - self.lower_m[axis]);
            let [x, y, z] = middle(self.lower_m, self.upper_m);
            let pose = Isometry3::translation(x, y, z);
            Surface::cuboid([half(0), half(1), half(2)].into()).placed(&pose)
        })
    }

    fn is_finite(&self) -> bool {
        let ends = self.lower_m.iter().chain(&self.upper_m);
        ends.copied().all(f64::is_finite)
    }

    /// Whether the line from a point to the viewer passes through the box.
    fn hides(&self, point: [f64; 3]) -> bool {
        const TOUCH_M: f64 = 1e-4;
        let ahead = view();
        let (mut enters, mut leaves) = (TOUCH_M, f64::INFINITY);
        for axis in 0..3 {
            let to = |wall: f64| (wall - point[axis]) / ahead[axis];
            let (a, b) = (to(self.lower_m[axis]), to(self.upper_m[axis]));
            enters = f64::max(enters, a.min(b));
            leaves = f64::min(leaves, a.max(b));
        }
        leaves > enters + TOUCH_M
    }

    /// Corners of a rectangle on the visible face of an axis; shares of the box along the other two axes.
    fn patch(&self, axis: usize, shares: [(f64, f64); 2]) -> [[f64; 3]; 4] {
        let level = visible_m(axis, [self.lower_m, self.upper_m]);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let [(s0, s1), (t0, t1)] = shares;
        [(s0, t0), (s1, t0), (s1, t1), (s0, t1)].map(|(s, t)| {
            let mut corner = [level; 3];
            corner[a] = self.lower_m[a] + s * (self.upper_m[a] - self.lower_m[a]);
            corner[b] = self.lower_m[b] + t * (self.upper_m[b] - self.lower_m[b]);
            corner
        })
    }
}

/// The middle of a face of this box that no other block hides: of the top if possible, else of a side, else the centre of the box.
pub(in crate::plot) fn seen_at(blocks: &[Block], lower_m: [f64; 3], upper_m: [f64; 3]) -> [f64; 3] {
    let centre = middle(lower_m, upper_m);
    let faces = [2, 1, 0].map(|axis| {
        let mut face = centre;
        face[axis] = visible_m(axis, [lower_m, upper_m]);
        face
    });
    let is_seen = |face: &[f64; 3]| !blocks.iter().any(|block| block.hides(*face));
    faces.into_iter().find(is_seen).unwrap_or(centre)
}

/// Corners of the picture of all boxes and of their floor before scaling, metres; `None` without any finite box.
pub(in crate::plot) fn extent(blocks: &[Block]) -> Option<(Point, Point)> {
    let finite = blocks.iter().filter(|block| block.is_finite());
    let corners = finite.flat_map(|block| block.surface().corners_m);
    let corners = corners.map(<[f64; 3]>::from).chain(floor(blocks)?);
    let (xs, ys): (Vec<f64>, Vec<f64>) = corners.map(project).unzip();
    let ((x0, x1), (y0, y1)) = (ends_of(xs), ends_of(ys));
    Some(((x0, y0), (x1, y1)))
}

/// Corners of the piece of floor below all boxes, and a bit around; `None` without any finite box.
fn floor(blocks: &[Block]) -> Option<[[f64; 3]; 4]> {
    let finite = || blocks.iter().filter(|block| block.is_finite());
    let lowest = |axis: usize| finite().map(|b| b.lower_m[axis]).reduce(f64::min);
    let highest = |axis: usize| finite().map(|b| b.upper_m[axis]).reduce(f64::max);
    let edges = finite().flat_map(|b| (0..3).map(|axis| b.upper_m[axis] - b.lower_m[axis]));
    let margin_m = FLOOR_MARGIN * edges.reduce(f64::max)?;
    let (x0, y0) = (lowest(0)? - margin_m, lowest(1)? - margin_m);
    let (x1, y1) = (highest(0)? + margin_m, highest(1)? + margin_m);
    let z = lowest(2)?;
    Some([[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| [x, y, z]))
}

/// The coordinate of the visible face of an axis, for a box with these corners.
fn visible_m(axis: usize, ends_m: [[f64; 3]; 2]) -> f64 {
    ends_m[usize::from(VISIBLE_POSITIVE[axis])][axis]
}

fn middle(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]))
}

/// Draws boxes on a piece of floor; `place` takes projected metres to the picture.
pub(in crate::plot) fn draw_blocks(
    canvas: &mut Canvas,
    blocks: &[Block],
    place: &impl Fn(Point) -> Point,
    line: f64,
) {
    draw_floor(canvas, blocks, place);
    let surfaces: Vec<Surface> = blocks.iter().map(Block::surface).collect();
    for index in far_first(&surfaces) {
        let block = &blocks[index];
        if block.surface.is_some() {
            let place = |point: [f64; 3]| place(project(point));
            let (surface, colour) = (&surfaces[index], colour_of(block.kind));
            draw_surface(canvas, surface, &place, colour, line);
        } else {
            draw_block(canvas, block, place, line);
        }
    }
}

fn draw_floor(canvas: &mut Canvas, blocks: &[Block], place: &impl Fn(Point) -> Point) {
    let Some(corners) = floor(blocks) else { return };
    let flat = |corners: [[f64; 3]; 4]| corners.map(|corner| place(project(corner)));
    canvas.polygon(&flat(corners), FLOOR);
    let floor_m = corners[0][2];
    for block in blocks.iter().filter(|block| block.is_finite()) {
        let shadow = shadow(&block.surface()).into_iter();
        let shadow = shadow.map(|[x, y]| place(project([x, y, floor_m])));
        canvas.polygon(&shadow.collect::<Vec<_>>(), SHADOW);
    }
}

/// Width of the piece of floor around a robot, as a share of the longest edge of its boxes.
const FLOOR_MARGIN: f64 = 0.45;

fn colour_of(kind: BlockKind) -> RGBColor {
    match kind {
        BlockKind::Passive | BlockKind::Body => PASSIVE,
        BlockKind::Active | BlockKind::DrivenBody => ACTIVE,
        BlockKind::Plate => SPIN,
    }
}

fn draw_block(canvas: &mut Canvas, block: &Block, place: &impl Fn(Point) -> Point, line: f64) {
    let colour = colour_of(block.kind);
    for axis in 0..3 {
        let flat = |corners: [[f64; 3]; 4]| corners.map(|corner| place(project(corner)));
        let shade = |colour| darken(colour, BRIGHTNESS[axis]);
        let face = flat(block.patch(axis, [(0.0, 1.0), (0.0, 1.0)]));
        canvas.polygon(&face, shade(colour));
        let driven = block.driven.filter(|_| block.kind == BlockKind::Active);
        if let Some((driven, shares)) = driven.and_then(|d| Some((d, band(axis, d)?))) {
            let colour = shade(motion_colour(driven.motion));
            canvas.polygon(&flat(block.patch(axis, shares)), colour);
        }
        let outline: Vec<Point> = face.iter().chain(&face[..1]).copied().collect();
        canvas.path(&outline, Stroke::new(line, INK));
        let turned = (axis, VISIBLE_POSITIVE[axis]);
        let turns = block.driven.is_some_and(|d| (d.axis, d.positive) == turned);
        if turns && block.kind == BlockKind::Plate {
            draw_turn(canvas, block, axis, place, 1.6 * line);
        }
    }
}

pub(in crate::plot) fn motion_colour(motion: Motion) -> RGBColor {
    match motion {
        Motion::Spin => SPIN,
        Motion::Bend => BEND,
    }
}

/// The strip of a visible face that lies along the driven face, so that it is seen from every side; all of the face if it
/// is the driven one.
fn band(axis: usize, driven: DrivenFace) -> Option<[(f64, f64); 2]> {
    const WIDTH: f64 = 0.16;
    const WHOLE: (f64, f64) = (0.0, 1.0);
    let strip = match driven.positive {
        true => (1.0 - WIDTH, 1.0),
        false => (0.0, WIDTH),
    };
    match (driven.axis + 3 - axis) % 3 {
        1 => Some([strip, WHOLE]),
        2 => Some([WHOLE, strip]),
        // The driven face itself is visible only where no module is glued onto it.
        _ => (driven.positive == VISIBLE_POSITIVE[axis]).then_some([WHOLE, WHOLE]),
    }
}

/// An arrow around the middle of a plate, in the direction of a positive angle.
fn draw_turn(
    canvas: &mut Canvas,
    block: &Block,
    axis: usize,
    place: &impl Fn(Point) -> Point,
    line: f64,
) {
    let white = tint(SPIN, 0.0);
    // The rotation is right-handed about the outward normal, so it is reversed where the normal points to smaller coordinates.
    let sense = if VISIBLE_POSITIVE[axis] { 1.0 } else { -1.0 };
    let at = |degrees: f64, radius: f64| {
        let (sin, cos) = (sense * degrees).to_radians().sin_cos();
        let share = |part: f64| 0.5 + radius * part;
        let (s, t) = (share(cos), share(sin));
        let [corner, ..] = block.patch(axis, [(s, s), (t, t)]);
        place(project(corner))
    };
    let arc = (0..=24).map(|step| at(40.0 + 10.0 * f64::from(step), 0.27));
    canvas.path(&arc.collect::<Vec<_>>(), Stroke::new(line, white));
    let tip = at(318.0, 0.27);
    canvas.polygon(&[at(276.0, 0.17), tip, at(276.0, 0.38)], white);
}

/// A scale bar: it shows how long a distance in the picture is.
pub(in crate::plot) fn draw_length(
    canvas: &mut Canvas,
    (left, right): Point,
    (y, half): Point,
    width: f64,
) {
    canvas.path(&[(left, y), (right, y)], Stroke::new(width, INK));
    for x in [left, right] {
        canvas.path(&[(x, y - half), (x, y + half)], Stroke::new(width, INK));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_is_right_and_up_is_up() {
        assert!(project([1.0, 0.0, 0.0]).0 > 0.0 && project([1.0, 0.0, 0.0]).1 > 0.0);
        assert!(project([0.0, 1.0, 0.0]).0 > 0.0 && project([0.0, 1.0, 0.0]).1 < 0.0);
        assert!(project([0.0, 0.0, 1.0]).0 == 0.0 && project([0.0, 0.0, 1.0]).1 < 0.0);
    }
}
