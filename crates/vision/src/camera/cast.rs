//! Casts rays in a scene: finds the first hit on the room, its blocks and posters through a bounding-volume hierarchy.

use super::scene::{Block, Poster, Scene};
use super::vector::{Vector, add, dot, less, times};

/// The object that a ray hits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Thing {
    /// One of the six sides of the room: the axis, and whether it is the far side.
    Side(usize, bool),
    /// A block and its face: the axis (3 + k for plane k), and whether the face looks along the axis.
    Block(usize, usize, bool),
    Poster(usize),
}

/// The first hit of a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub distance_m: f64,
    pub thing: Thing,
    pub normal: Vector,
}

#[derive(Debug, Clone, Copy)]
enum Solid {
    Block(usize),
    Poster(usize),
}

/// A node of the hierarchy with its bounding box; the children of an inner node are the next node and `other`.
#[derive(Debug, Clone)]
struct Node {
    low: Vector,
    high: Vector,
    other: usize,
    things: std::ops::Range<usize>,
}

/// A scene with the hierarchy for casting rays.
pub(super) struct Caster<'a> {
    scene: &'a Scene,
    nodes: Vec<Node>,
    solids: Vec<Solid>,
}

/// Largest number of objects in a leaf.
const LEAF: usize = 3;
/// Distance of posters from the wall behind them, and smallest distance of a hit, metres.
pub(super) const BEFORE_M: f64 = 1e-4;

fn bounds(scene: &Scene, solid: Solid) -> (Vector, Vector) {
    match solid {
        Solid::Block(index) => {
            let Block {
                centre_m,
                half_m,
                axes,
                ..
            } = &scene.blocks[index];
            let reach = [0, 1, 2].map(|i| dot(axes.map(|axis| axis[i].abs()), *half_m));
            (less(*centre_m, reach), add(*centre_m, reach))
        }
        Solid::Poster(index) => {
            let poster = &scene.posters[index];
            let reach = [0, 1, 2].map(|i| poster.right_m[i].abs() + poster.down_m[i].abs() + 1e-6);
            (less(poster.centre_m, reach), add(poster.centre_m, reach))
        }
    }
}

impl<'a> Caster<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let blocks = (0..scene.blocks.len()).map(Solid::Block);
        let mut solids: Vec<Solid> = blocks
            .chain((0..scene.posters.len()).map(Solid::Poster))
            .collect();
        let mut nodes = Vec::new();
        let count = solids.len();
        if count > 0 {
            split(scene, &mut solids, 0..count, &mut nodes);
        }
        Self {
            scene,
            nodes,
            solids,
        }
    }

    /// The first hit of a camera's ray from inside of the room; invisible blocks are ignored.
    pub(super) fn first(&self, from: Vector, direction: Vector) -> Hit {
        let mut best = self.side(from, direction);
        self.visit(from, direction, best.distance_m, |solid, nearest| {
            if self.is_seen(solid)
                && let Some(hit) = self.meet(solid, from, direction)
                && hit.distance_m < *nearest
            {
                *nearest = hit.distance_m;
                best = hit;
            }
            true
        });
        best
    }

    /// Whether the line between two points is free of blocks and posters.
    pub(super) fn sees(&self, from: Vector, to: Vector) -> bool {
        let way = less(to, from);
        let distance = dot(way, way).sqrt();
        let direction = times(way, 1.0 / distance);
        let mut is_free = true;
        self.visit(from, direction, distance, |solid, _| {
            let hit = self.meet(solid, from, direction);
            is_free = hit.is_none_or(|h| h.distance_m >= distance);
            is_free
        });
        is_free
    }

    /// Visits the objects that a ray may hit at a distance below `nearest`. The visitor may lower `nearest`, and returns whether to go on.
    fn visit(
        &self,
        from: Vector,
        direction: Vector,
        nearest: f64,
        mut visitor: impl FnMut(Solid, &mut f64) -> bool,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = direction.map(|d| 1.0 / d);
        let mut nearest = nearest;
        // The stack is deep enough for any number of objects, because every level of the hierarchy halves them.
        let mut open = [0_usize; 64];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = open[count];
            let node = &self.nodes[index];
            let (mut enter, mut leave) = (0.0_f64, nearest);
            for axis in 0..3 {
                let a = (node.low[axis] - from[axis]) * inverse[axis];
                let b = (node.high[axis] - from[axis]) * inverse[axis];
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
            if enter > leave {
                continue;
            }
            if node.other == 0 {
                for solid in &self.solids[node.things.clone()] {
                    if !visitor(*solid, &mut nearest) {
                        return;
                    }
                }
            } else if count + 2 <= open.len() {
                open[count] = node.other;
                open[count + 1] = index + 1;
                count += 2;
            }
        }
    }

    fn is_seen(&self, solid: Solid) -> bool {
        match solid {
            Solid::Block(index) => self.scene.blocks[index].is_seen,
            Solid::Poster(_) => true,
        }
    }

    /// The hit of a ray from inside on a side of the room.
    fn side(&self, from: Vector, direction: Vector) -> Hit {
        let mut best = (f64::INFINITY, 0, false);
        for axis in 0..3 {
            let is_far = direction[axis] > 0.0;
            let wall = if is_far { self.scene.room_m[axis] } else { 0.0 };
            let distance = (wall - from[axis]) / direction[axis];
            if direction[axis] != 0.0 && distance < best.0 {
                best = (distance, axis, is_far);
            }
        }
        let mut normal = [0.0; 3];
        normal[best.1] = if best.2 { -1.0 } else { 1.0 };
        Hit {
            distance_m: best.0.max(0.0),
            thing: Thing::Side(best.1, best.2),
            normal,
        }
    }

    fn meet(&self, solid: Solid, from: Vector, direction: Vector) -> Option<Hit> {
        match solid {
            Solid::Block(index) => meet_block(&self.scene.blocks[index], index, from, direction),
            Solid::Poster(index) => {
                let distance_m = meet_poster(&self.scene.posters[index], from, direction)?.0;
                Some(Hit {
                    distance_m,
                    thing: Thing::Poster(index),
                    normal: self.scene.posters[index].normal(),
                })
            }
        }
    }
}

/// Distance to the front of a poster, and coordinates of the hit from −1 to 1 to the right and down.
pub(super) fn meet_poster(
    poster: &Poster,
    from: Vector,
    direction: Vector,
) -> Option<(f64, f64, f64)> {
    let normal = poster.normal();
    let against = dot(normal, direction);
    // The back of a poster is invisible.
    if against >= 0.0 {
        return None;
    }
    let distance = dot(less(poster.centre_m, from), normal) / against;
    if distance <= BEFORE_M {
        return None;
    }
    let at = less(add(from, times(direction, distance)), poster.centre_m);
    let u = dot(at, poster.right_m) / dot(poster.right_m, poster.right_m);
    let v = dot(at, poster.down_m) / dot(poster.down_m, poster.down_m);
    (u.abs() <= 1.0 && v.abs() <= 1.0).then_some((distance, u, v))
}

fn meet_block(block: &Block, index: usize, from: Vector, direction: Vector) -> Option<Hit> {
    let (from, towards) = (block.own_m(from), block.own(direction));
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut face = (0, false);
    let mut normal = None;
    for axis in 0..3 {
        let inverse = 1.0 / towards[axis];
        let a = (-block.half_m[axis] - from[axis]) * inverse;
        let b = (block.half_m[axis] - from[axis]) * inverse;
        if a.min(b) > enter {
            enter = a.min(b);
            face = (axis, towards[axis] < 0.0);
        }
        leave = leave.min(a.max(b));
    }
    for (number, plane) in block.planes.iter().enumerate() {
        let (along, clearance) = (
            dot(plane.normal, towards),
            plane.level_m - dot(plane.normal, from),
        );
        if along > 0.0 {
            leave = leave.min(clearance / along);
        } else if along < 0.0 && clearance / along > enter {
            enter = clearance / along;
            face = (3 + number, true);
            normal = Some(plane.normal);
        } else if along == 0.0 && clearance < 0.0 {
            return None;
        }
    }
    if enter > leave || enter <= BEFORE_M {
        return None;
    }
    let own = normal.map(|own| less(block.point_m(own), block.centre_m));
    Some(Hit {
        distance_m: enter,
        thing: Thing::Block(index, face.0, face.1),
        normal: own.unwrap_or_else(|| times(block.axes[face.0], if face.1 { 1.0 } else { -1.0 })),
    })
}

/// Adds the hierarchy of some objects; they are halved along the axis on which their centres have the largest extent.
fn split(
    scene: &Scene,
    solids: &mut [Solid],
    range: std::ops::Range<usize>,
    nodes: &mut Vec<Node>,
) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (mut near, mut far) = (low, high);
    for solid in &solids[range.clone()] {
        let (a, b) = bounds(scene, *solid);
        for axis in 0..3 {
            let middle = 0.5 * (a[axis] + b[axis]);
            low[axis] = low[axis].min(a[axis]);
            high[axis] = high[axis].max(b[axis]);
            near[axis] = near[axis].min(middle);
            far[axis] = far[axis].max(middle);
        }
    }
    let index = nodes.len();
    nodes.push(Node {
        low,
        high,
        other: 0,
        things: range.clone(),
    });
    if range.len() <= LEAF {
        return;
    }
    let spread = less(far, near);
    let axis = (0..3)
        .max_by(|a, b| spread[*a].total_cmp(&spread[*b]))
        .unwrap_or(0);
    solids[range.clone()].sort_by(|a, b| {
        let middle = |s: &Solid| {
            let (low, high) = bounds(scene, *s);
            low[axis] + high[axis]
        };
        middle(a).total_cmp(&middle(b))
    });
    let half = range.start + range.len() / 2;
    split(scene, solids, range.start..half, nodes);
    nodes[index].other = nodes.len();
    split(scene, solids, half..range.end, nodes);
}
