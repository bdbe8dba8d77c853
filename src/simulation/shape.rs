//! The fewest boxes that cover a rigid cluster exactly: every box costs contact points.

use nalgebra::{Isometry3, Vector3};

use crate::morphology::{Part, Role};

/// A box along the axes of its part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block {
    pub centre_part_m: Vector3<f64>,
    pub half_extents_m: Vector3<f64>,
    pub edge_radius_m: f64,
}

/// Lengths closer than this are the same, metres.
const SAME_M: f64 = 1e-9;

/// The collision boxes of a part in its own frame, those merged that fill a larger box together.
///
/// Modules are glued by quarter turns, so every box lies along the axes of its part. Boxes with rounded edges
/// are left alone: rounding the whole is not rounding its pieces.
pub(super) fn blocks(
    part: &Part,
    part_from_robot: &Isometry3<f64>,
    edge_radius_m: f64,
) -> Vec<Block> {
    let mut blocks: Vec<Block> = part
        .solids
        .iter()
        .filter(|solid| solid.collides)
        .map(|solid| {
            let pose = part_from_robot * solid.robot_from_solid;
            let turn = pose.rotation.to_rotation_matrix();
            let half_extents_m = (turn.matrix() * solid.half_extents_m).abs();
            let edge_radius_m = if solid.role == Role::Cube {
                edge_radius_m
            } else {
                0.0
            };
            Block {
                centre_part_m: pose.translation.vector,
                half_extents_m,
                edge_radius_m,
            }
        })
        .collect();
    while let Some((kept, gone, merged)) = mergeable(&blocks) {
        blocks[kept] = merged;
        blocks.remove(gone);
    }
    blocks
}

fn mergeable(blocks: &[Block]) -> Option<(usize, usize, Block)> {
    (0..blocks.len()).find_map(|first| {
        (first + 1..blocks.len()).find_map(|second| {
            merge(&blocks[first], &blocks[second]).map(|merged| (first, second, merged))
        })
    })
}

/// The box that two boxes fill together, if they do.
fn merge(a: &Block, b: &Block) -> Option<Block> {
    if a.edge_radius_m > 0.0 || b.edge_radius_m > 0.0 {
        return None;
    }
    let apart = b.centre_part_m - a.centre_part_m;
    let same = |x: f64, y: f64| (x - y).abs() < SAME_M;
    (0..3).find_map(|axis| {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let aligned = others
            .iter()
            .all(|&i| same(apart[i], 0.0) && same(a.half_extents_m[i], b.half_extents_m[i]));
        let touching = same(
            apart[axis].abs(),
            a.half_extents_m[axis] + b.half_extents_m[axis],
        );
        (aligned && touching).then(|| {
            let mut half_extents_m = a.half_extents_m;
            half_extents_m[axis] += b.half_extents_m[axis];
            let mut centre_part_m = a.centre_part_m;
            // From the outer face of `a` to the middle of the whole.
            let outer = a.centre_part_m[axis] - a.half_extents_m[axis].copysign(apart[axis]);
            centre_part_m[axis] = outer + half_extents_m[axis].copysign(apart[axis]);
            Block {
                centre_part_m,
                half_extents_m,
                edge_radius_m: 0.0,
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f64, y: f64, z: f64) -> Block {
        Block {
            centre_part_m: Vector3::new(x, y, z),
            half_extents_m: Vector3::repeat(0.5),
            edge_radius_m: 0.0,
        }
    }

    fn merged(mut blocks: Vec<Block>) -> Vec<Block> {
        while let Some((kept, gone, merged)) = mergeable(&blocks) {
            blocks[kept] = merged;
            blocks.remove(gone);
        }
        blocks
    }

    #[test]
    fn four_cubes_in_a_square_are_one_box() {
        let square = merged(vec![
            cube(0.0, 0.0, 0.0),
            cube(1.0, 1.0, 0.0),
            cube(1.0, 0.0, 0.0),
            cube(0.0, 1.0, 0.0),
        ]);
        assert_eq!(square.len(), 1);
        assert!((square[0].centre_part_m - Vector3::new(0.5, 0.5, 0.0)).norm() < 1e-12);
        assert_eq!(square[0].half_extents_m, Vector3::new(1.0, 1.0, 0.5));
    }

    #[test]
    fn an_angle_keeps_its_corner_and_its_volume() {
        let angle = merged(vec![
            cube(0.0, 0.0, 0.0),
            cube(-1.0, 0.0, 0.0),
            cube(0.0, -1.0, 0.0),
        ]);
        assert_eq!(angle.len(), 2);
        let volume: f64 = angle.iter().map(|b| 8.0 * b.half_extents_m.product()).sum();
        assert!((volume - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_plate_larger_than_its_cube_stays_apart() {
        let plate = Block {
            centre_part_m: Vector3::new(0.6, 0.0, 0.0),
            half_extents_m: Vector3::new(0.1, 0.55, 0.55),
            edge_radius_m: 0.0,
        };
        assert_eq!(merged(vec![cube(0.0, 0.0, 0.0), plate]).len(), 2);
    }
}
