//! Posture of a robot at one moment: its clearance above the floor, and the overlap of its own parts.

use nalgebra::Isometry3;

use super::experiment::Floor;
use super::kinematics::{lowest_m, robot_from_part_at_zero};
use super::rapier::parry::query;
use super::rapier::{Surface, to_pose};
use super::watch::Snapshot;
use realgap_robot::morphology::{Assembly, Solid};

/// The collision shapes of a robot, prepared for the evaluation of many snapshots.
#[derive(Debug)]
pub struct Posture<'a> {
    assembly: &'a Assembly,
    /// The solids with a surface, each with its part and its pose in the part's frame.
    boxes: Vec<(usize, Isometry3<f64>, &'a Solid)>,
    surfaces: Vec<Surface>,
    /// Pairs of solids whose parts no hinge connects.
    pairs: Vec<(usize, usize)>,
}

impl<'a> Posture<'a> {
    /// Prepares the collision shapes of a robot.
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

    /// Distance of the lowest point from the floor, metres; negative if it is below the floor.
    pub fn clearance_m(&self, snapshot: &Snapshot, floor: &Floor) -> f64 {
        let poses: Vec<_> = snapshot.parts.iter().map(|p| p.world_from_part).collect();
        self.above_m(&poses, floor)
    }

    /// The same for a robot whose joints are all at zero, from the pose of the tracked module.
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

    /// Largest penetration depth of two solids of parts that no hinge connects, metres; 0 if none overlap. Rounded edges count as
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
            let distance_m = (placed[a].translation.vector - placed[b].translation.vector).norm();
            if distance_m > half_a.norm() + half_b.norm() {
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
