//! How a robot stands at one moment: how far above the floor, and whether it is inside of itself.

use nalgebra::Isometry3;

use super::experiment::Floor;
use super::kinematics::{lowest_m, robot_from_part_at_zero};
use super::rapier::parry::query;
use super::rapier::{Surface, to_pose};
use super::watch::Snapshot;
use realgap_robot::morphology::{Assembly, Solid};

/// The boxes of a robot, ready to be looked at in many snapshots.
#[derive(Debug)]
pub struct Posture<'a> {
    assembly: &'a Assembly,
    /// Everything that touches, with its part and its pose in the part's frame.
    boxes: Vec<(usize, Isometry3<f64>, &'a Solid)>,
    surfaces: Vec<Surface>,
    /// Pairs of boxes whose parts no hinge joins.
    pairs: Vec<(usize, usize)>,
}

impl<'a> Posture<'a> {
    /// The boxes of a robot.
    pub fn new(assembly: &'a Assembly) -> Self {
        let mut boxes = Vec::new();
        for (index, part) in assembly.parts.iter().enumerate() {
            let part_from_robot = robot_from_part_at_zero(assembly, index).inverse();
            for solid in part.solids.iter().filter(|solid| solid.has_surface()) {
                boxes.push((index, part_from_robot * solid.robot_from_solid, solid));
            }
        }
        let is_joined = |a: usize, b: usize| {
            assembly.hinges.iter().any(|hinge| {
                let ends = (hinge.parent_part, hinge.child_part);
                ends == (a, b) || ends == (b, a)
            })
        };
        let mut pairs = Vec::new();
        for (first, (a, ..)) in boxes.iter().enumerate() {
            for (second, (b, ..)) in boxes.iter().enumerate().skip(first + 1) {
                if a != b && !is_joined(*a, *b) {
                    pairs.push((first, second));
                }
            }
        }
        let sharp =
            |(_, _, solid): &(usize, Isometry3<f64>, &Solid)| Surface::new(&solid.shape, 0.0);
        Self {
            assembly,
            surfaces: boxes.iter().filter_map(sharp).collect(),
            boxes,
            pairs,
        }
    }

    /// Distance of the lowest point to the floor, metres; below 0 inside of it.
    pub fn clearance_m(&self, snapshot: &Snapshot, floor: &Floor) -> f64 {
        let poses: Vec<_> = snapshot.parts.iter().map(|p| p.world_from_part).collect();
        self.above_m(&poses, floor)
    }

    /// The same of a robot whose joints are all at zero, from the pose of what is tracked.
    pub fn rigid_clearance_m(&self, world_from_track: &Isometry3<f64>, floor: &Floor) -> f64 {
        let world_from_robot = world_from_track * self.assembly.robot_from_track.inverse();
        let poses: Vec<_> = (0..self.assembly.parts.len())
            .map(|part| world_from_robot * robot_from_part_at_zero(self.assembly, part))
            .collect();
        self.above_m(&poses, floor)
    }

    fn above_m(&self, world_from_parts: &[Isometry3<f64>], floor: &Floor) -> f64 {
        let normal = floor.normal_world();
        lowest_m(self.assembly, world_from_parts, &normal) - floor.height_m * normal.z
    }

    /// How deep two boxes of parts that no hinge joins are inside each other, metres, the deepest of all; 0 for none. Edges count as
    /// sharp.
    pub fn overlap_m(&self, snapshot: &Snapshot) -> f64 {
        let placed: Vec<Isometry3<f64>> = self
            .boxes
            .iter()
            .map(|(part, part_from_box, _)| snapshot.parts[*part].world_from_part * part_from_box)
            .collect();
        let mut deepest_m = 0.0_f64;
        for &(a, b) in &self.pairs {
            let (half_a, half_b) = (
                self.boxes[a].2.half_extents_m(),
                self.boxes[b].2.half_extents_m(),
            );
            let apart_m = (placed[a].translation.vector - placed[b].translation.vector).norm();
            if apart_m > half_a.norm() + half_b.norm() {
                continue;
            }
            let (first, second) = (&self.surfaces[a], &self.surfaces[b]);
            let at = |index: usize, surface: &Surface| to_pose(&surface.pose(placed[index]));
            let (here, there) = (at(a, first), at(b, second));
            if let Ok(Some(contact)) =
                query::contact(&here, &*first.shape, &there, &*second.shape, 0.0)
            {
                deepest_m = deepest_m.max(-contact.dist);
            }
        }
        deepest_m
    }
}
