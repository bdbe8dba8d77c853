//! Counts on which face robots come to rest, and measures the height of the tracked point at rest.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use super::bootstrap::{Interval, intervals, weighted_mean};
use super::flight::Body;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Face;

/// A body that moves and turns less than this over the last `WINDOW_S` is at rest.
const REST_M: f64 = 3e-4;
const REST_RAD: f64 = 3e-3;
const WINDOW_S: f64 = 0.02;
/// The same limit for joint angles, which is larger because encoders of joints are coarser, radians.
const REST_JOINT_RAD: f64 = 1e-2;

/// How often a face of the tracked module ended down.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaceCount {
    /// Name of the face in the tracked module's frame.
    pub face: &'static str,
    /// Number of recordings that ended at rest on this face.
    pub down: usize,
}

/// Resting poses of many recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RestReport {
    /// Number of recordings that end at rest.
    pub at_rest: usize,
    /// Number of recordings that end while the robot moves, or that have no orientations.
    pub moving: usize,
    /// Counts, in the order of the faces' names in files.
    pub faces: Vec<FaceCount>,
    /// Recorded height of the tracked point above the floor at rest, divided by the height that follows from the robot's size.
    pub height_ratio: Option<Interval>,
}

/// The face of the tracked module that points most nearly down.
pub fn face_down(world_from_body: &UnitQuaternion<f64>, floor_normal_world: &Vector3<f64>) -> Face {
    let down = world_from_body.inverse() * -floor_normal_world;
    let mut best = Face::ALL[0];
    for face in Face::ALL {
        if face.normal().dot(&down) > best.normal().dot(&down) {
            best = face;
        }
    }
    best
}

/// Whether the robot is at rest at the end of the recording; false if the recording has no orientations.
pub fn is_at_rest(motion: &Trajectory) -> bool {
    let Some(orientations) = motion.orientations_world_from_body() else {
        return false;
    };
    let (times_s, last) = (motion.times_s(), motion.len() - 1);
    let before = times_s
        .iter()
        .rposition(|t| *t <= times_s[last] - WINDOW_S + 1e-9)
        .unwrap_or(0);
    let moved = motion.positions_world_m()[last] - motion.positions_world_m()[before];
    let joints_rest = motion
        .joints()
        .iter()
        .all(|joint| (joint.angles_rad[last] - joint.angles_rad[before]).abs() < REST_JOINT_RAD);
    moved.norm() < REST_M
        && orientations[before].angle_to(&orientations[last]) < REST_RAD
        && joints_rest
}

impl RestReport {
    /// Counts the resting faces of these motions, whose lengths are in the same unit as those of the body.
    pub fn new(body: &Body, motions: &[&Trajectory], seed: u64) -> Self {
        let normal = body.floor().normal_world();
        let mut counts = [0_usize; 6];
        let mut ratios = Vec::new();
        for motion in motions.iter().filter(|motion| is_at_rest(motion)) {
            let last = motion.len() - 1;
            let Some(orientations) = motion.orientations_world_from_body() else {
                continue;
            };
            let face = face_down(&orientations[last], &normal);
            if let Some(index) = Face::ALL.iter().position(|known| *known == face) {
                counts[index] += 1;
            }
            let height_m =
                motion.positions_world_m()[last].dot(&normal) - normal.z * body.floor().height_m;
            ratios.push(height_m / body.reach_m(&face.normal()));
        }
        let at_rest = counts.iter().sum();
        let height_ratio = intervals(ratios.len(), seed, |w| weighted_mean(w, &ratios));
        Self {
            at_rest,
            moving: motions.len() - at_rest,
            faces: Face::ALL
                .iter()
                .zip(counts)
                .map(|(face, down)| FaceCount {
                    face: face.name(),
                    down,
                })
                .collect(),
            height_ratio: height_ratio.map(|[ratio]| ratio),
        }
    }
}
