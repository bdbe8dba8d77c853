//! Finds the free flight of a robot without servos: the samples before any part of the robot comes near the floor.

use nalgebra::{Isometry3, Vector3};

use super::linkage::Linkage;

use realgap_core::error::{Advice, Error, Result};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::{Part, Solid};
use realgap_simulation::{Experiment, Floor};

/// Share of the body length by which the lowest corner must clear the floor: about the error of a tracker
/// plus the distance that the robot falls in one sample.
const CLEARANCE: f64 = 0.03;

/// Share of the body length by which the lowest corner of a jointed robot must clear the floor at the next sample. Heights of
/// hinged boxes that were tossed are off by up to 8 mm of 0.1 m where they first touch (docs/validation/hardware.md).
const JOINTED: f64 = 0.12;

/// Up to this ratio of the principal moments a free body turns at a nearly constant rate.
pub const EQUAL_MOMENTS: f64 = 1.05;

/// The properties of a robot without servos that matter for its flight: corners, centre of mass, and the floor below.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Centre of mass in the tracked frame, metres; for a jointed robot, at zero angles.
    pub centre_track_m: Vector3<f64>,
    /// Magnitude of gravity, along −z of the world, m/s².
    pub gravity_m_s2: f64,
    /// Largest over smallest principal moment of inertia; 1 for a cube.
    pub moment_ratio: f64,
    /// The hinged parts of a jointed robot; `None` for one rigid part.
    pub linkage: Option<Linkage>,
    /// Corners of each part, in the tracked frame at zero angles.
    corners_track_m: Vec<Vec<Vector3<f64>>>,
    floor: Floor,
    clearance_m: f64,
}

impl Body {
    /// The robot of an experiment, with its adjustments.
    ///
    /// # Errors
    /// A robot with servos, or a robot with hinges of which another part than the root is tracked.
    pub fn new(experiment: &Experiment) -> Result<Self> {
        let robot = experiment.adjusted_assembly();
        let linkage = Linkage::new(&robot);
        if robot.parts.len() != 1 && linkage.is_none() {
            let servos = robot.hinges.iter().filter(|h| h.actuator.is_some()).count();
            return Err(
                Error::invalid("only robots without servos can be identified from free flight")
                    .found(format!("a robot with {servos} servos and {} hinges", robot.hinges.len()))
                    .allowed("one rigid part, or parts on passive hinges whose root is tracked")
                    .hint("walking robots are never in free flight; if possible, toss the body without its servos")
                    .advise(Advice::LeastSquares),
            );
        }
        let track_from_robot = robot.robot_from_track.inverse();
        let corners_track_m = robot
            .parts
            .iter()
            .map(|part| {
                let solids = part.solids.iter().filter(|solid| solid.collides);
                solids
                    .flat_map(|solid| corners(solid, &track_from_robot))
                    .collect()
            })
            .collect();
        let whole = Part {
            solids: robot
                .parts
                .iter()
                .flat_map(|part| part.solids.clone())
                .collect(),
        };
        let mass = whole.mass(&track_from_robot);
        let moments = mass.inertia_kg_m2.symmetric_eigenvalues();
        Ok(Self {
            centre_track_m: mass.centre_m,
            gravity_m_s2: experiment.gravity_m_s2,
            moment_ratio: moments.max() / moments.min(),
            linkage,
            corners_track_m,
            // The contact properties of the floor do not matter in flight.
            floor: Floor {
                height_m: experiment.floor.height_m,
                slope_rad: experiment.floor.slope_rad,
                ..Floor::default()
            },
            clearance_m: CLEARANCE * robot.body_length_m,
        })
    }

    /// Number of samples, from the first on, that are certainly in flight; 0 if the run starts on the floor or has no
    /// orientations. `motion` is in true lengths.
    ///
    /// The sample before the first one near the floor is left out, too, because a contact may follow it before the next sample.
    pub(crate) fn flight_samples(&self, motion: &Trajectory) -> usize {
        let Some(orientations) = motion.orientations_world_from_body() else {
            return 0;
        };
        let normal = self.floor.normal_world();
        let below_m = normal.z * self.floor.height_m;
        let Some(joints) = self.joints_of(motion) else {
            return 0;
        };
        let poses = motion.positions_world_m().iter().zip(orientations);
        let clear_m = poses.enumerate().map(|(sample, (position, turn))| {
            let along = turn.inverse() * normal;
            let angles_rad: Vec<f64> = joints.iter().map(|all| all[sample]).collect();
            position.dot(&normal) - below_m + self.lowest_along_m(&angles_rad, &along)
        });
        if self.linkage.is_none() {
            return clear_m
                .take_while(|clear_m| *clear_m >= self.clearance_m)
                .count()
                .saturating_sub(1);
        }
        // Long thin parts can touch the floor between two samples that are both clear of it. Therefore the flight ends before the
        // first sample that would be too low if the height went on changing at the same rate.
        let (mut samples, mut last_m) = (0_usize, f64::NAN);
        for here_m in clear_m {
            if here_m < self.clearance_m {
                return samples.saturating_sub(1);
            }
            samples += 1;
            if here_m + (here_m - last_m) < JOINTED / CLEARANCE * self.clearance_m {
                break;
            }
            last_m = here_m;
        }
        samples
    }

    /// Recorded angles of the robot's joints; `None` if a joint is not recorded.
    fn joints_of<'a>(&self, motion: &'a Trajectory) -> Option<Vec<&'a [f64]>> {
        let names = self.linkage.iter().flat_map(Linkage::joint_names);
        names
            .map(|name| Some(motion.joint(name)?.angles_rad.as_slice()))
            .collect()
    }

    /// The smallest coordinate of any corner along a direction of the tracked frame, metres.
    fn lowest_along_m(&self, angles_rad: &[f64], along_track: &Vector3<f64>) -> f64 {
        let moved = match &self.linkage {
            Some(linkage) => linkage.moved(angles_rad),
            None => vec![Isometry3::identity()],
        };
        let mut lowest_m = f64::INFINITY;
        for (pose, corners) in moved.iter().zip(&self.corners_track_m) {
            for corner in corners {
                let at = match &self.linkage {
                    Some(_) => (pose * nalgebra::Point3::from(*corner)).coords,
                    None => *corner,
                };
                lowest_m = lowest_m.min(at.dot(along_track));
            }
        }
        lowest_m
    }

    /// Distance from the tracked point to the outermost corner along a direction of the tracked frame, metres.
    pub fn reach_m(&self, along_track: &Vector3<f64>) -> f64 {
        self.corners_track_m
            .iter()
            .flatten()
            .map(|corner| corner.dot(along_track))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The floor below the robot, without its contact properties.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }
}

/// The eight corners of a box in the tracked frame.
fn corners(solid: &Solid, track_from_robot: &Isometry3<f64>) -> Vec<Vector3<f64>> {
    let pose = track_from_robot * solid.robot_from_solid;
    let h = solid.half_extents_m();
    (0..8)
        .map(|corner| {
            let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let at = Vector3::new(sign(0) * h.x, sign(1) * h.y, sign(2) * h.z);
            (pose * nalgebra::Point3::from(at)).coords
        })
        .collect()
}
