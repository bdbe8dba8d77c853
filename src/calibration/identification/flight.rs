//! Finding the free flight of a rigid robot: the samples before anything of it comes near the floor.

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, Result};
use crate::simulation::{Experiment, Floor};
use crate::trajectory::Trajectory;

/// Share of the body length by which the lowest corner must clear the floor: about the error of a tracker
/// plus what the robot sinks in a sample.
const CLEARANCE: f64 = 0.03;

/// Up to this ratio of the principal moments a free body turns at a nearly constant rate.
pub const EQUAL_MOMENTS: f64 = 1.05;

/// A rigid robot as its flight sees it: where its corners and its centre of mass are, and the floor below.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Centre of mass in the tracked frame, metres.
    pub centre_track_m: Vector3<f64>,
    /// Magnitude of gravity, along −z of the world, m/s².
    pub gravity_m_s2: f64,
    /// Largest over smallest principal moment of inertia; 1 for a cube.
    pub moment_ratio: f64,
    corners_track_m: Vec<Vector3<f64>>,
    floor: Floor,
    clearance_m: f64,
}

impl Body {
    /// The robot of an experiment, with its adjustments.
    ///
    /// # Errors
    /// A robot with servos: its centre of mass moves in the body.
    pub fn new(experiment: &Experiment) -> Result<Self> {
        let robot = experiment.adjusted_assembly();
        let [part] = robot.parts.as_slice() else {
            return Err(
                Error::invalid("free flight says something about rigid robots only")
                    .found(format!("a robot with {} servos", robot.hinges.len()))
                    .allowed("one rigid part: passive modules only")
                    .hint("walkers have no free flight to learn from; toss the body without its servos, if it can be had"),
            );
        };
        let track_from_robot = robot.robot_from_track.inverse();
        let mut mass_kg = 0.0;
        let mut moment = Vector3::zeros();
        let mut corners_track_m = Vec::new();
        for solid in &part.solids {
            let pose = track_from_robot * solid.robot_from_solid;
            mass_kg += solid.mass_kg;
            moment += (pose * nalgebra::Point3::from(solid.centre_of_mass_solid_m)).coords
                * solid.mass_kg;
            for corner in 0..8 {
                let h = &solid.half_extents_m;
                let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let at = Vector3::new(sign(0) * h.x, sign(1) * h.y, sign(2) * h.z);
                corners_track_m.push((pose * nalgebra::Point3::from(at)).coords);
            }
        }
        let centre_track_m = moment / mass_kg;
        let mut inertia = Matrix3::zeros();
        for solid in &part.solids {
            let pose = track_from_robot * solid.robot_from_solid;
            let turn = pose.rotation.to_rotation_matrix();
            let centre = (pose * nalgebra::Point3::from(solid.centre_of_mass_solid_m)).coords;
            let d = centre - centre_track_m;
            inertia += turn * solid.inertia_kg_m2 * turn.transpose()
                + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * solid.mass_kg;
        }
        let moments = inertia.symmetric_eigenvalues();
        Ok(Self {
            centre_track_m,
            gravity_m_s2: experiment.gravity_m_s2,
            moment_ratio: moments.max() / moments.min(),
            corners_track_m,
            floor: experiment.floor,
            clearance_m: CLEARANCE * robot.body_length_m,
        })
    }

    /// How many samples from the first are surely in flight; 0 where the run starts on the floor or has no
    /// orientations. `motion` is in true lengths.
    ///
    /// The sample before the first that comes near the floor is left out too: it may already hide a contact.
    pub fn flight_samples(&self, motion: &Trajectory) -> usize {
        let Some(orientations) = motion.orientations_world_from_body() else {
            return 0;
        };
        let normal = self.floor.normal_world();
        let below_m = normal.z * self.floor.height_m;
        motion
            .positions_world_m()
            .iter()
            .zip(orientations)
            .take_while(|(position, world_from_track)| {
                let along = world_from_track.inverse() * normal;
                let lowest = self
                    .corners_track_m
                    .iter()
                    .map(|corner| corner.dot(&along))
                    .fold(f64::INFINITY, f64::min);
                position.dot(&normal) - below_m + lowest >= self.clearance_m
            })
            .count()
            .saturating_sub(1)
    }

    /// How far the tracked point is from the outside of the robot along a direction of the tracked frame, metres.
    pub fn reach_m(&self, along_track: &Vector3<f64>) -> f64 {
        self.corners_track_m
            .iter()
            .map(|corner| corner.dot(along_track))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The floor below.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }
}
