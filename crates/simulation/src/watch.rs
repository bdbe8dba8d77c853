//! Observation of a run: hooks that are called during it, and snapshots of all parts and hinges.

use nalgebra::{Isometry3, Point3, Vector3};

use super::control::Feedback;
use super::engine::World;
use super::kinematics::robot_from_part_at_zero;
use super::part_state::PartState;
use realgap_core::error::{Error, Result};
use realgap_robot::morphology::Assembly;

/// A callback that is called with a snapshot at time 0 and after every step.
pub type Observer<'a> = Option<&'a mut dyn FnMut(&Snapshot)>;

/// Callbacks of a run; by default there are none.
#[derive(Default)]
pub struct RunHooks<'a> {
    /// Called for every step as in [`watch`](super::run::watch); not available for a vehicle, which has no parts.
    pub observer: Observer<'a>,
    /// Called for every decision of a controller, and may override it.
    pub feedback: Option<Feedback<'a>>,
    /// Called before every step with the completed fraction of the run, from 0 to 1; an error that it returns ends the run. Not
    /// called for a vehicle.
    pub clock: Option<&'a mut dyn FnMut(f64) -> Result<()>>,
}

impl RunHooks<'_> {
    /// Calls the clock with the number of completed steps.
    pub fn report_progress(&mut self, done: u64, steps: u64) -> Result<()> {
        match &mut self.clock {
            Some(clock) => clock(done as f64 / steps.max(1) as f64),
            None => Ok(()),
        }
    }
}

/// A velocity that is added to one part without hinges at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Index of the part.
    pub part: usize,
    /// Added velocity of its centre of mass, world frame, m/s.
    pub velocity_world_m_s: Vector3<f64>,
}

impl Push {
    pub(super) fn check(&self, assembly: &Assembly) -> Result<()> {
        let hinged = |part| {
            assembly
                .hinges
                .iter()
                .any(|hinge| hinge.parent_part == part || hinge.child_part == part)
        };
        if self.part < assembly.parts.len() && !hinged(self.part) {
            return Ok(());
        }
        Err(Error::invalid("only a part without hinges can be pushed")
            .field("part")
            .found(self.part)
            .allowed(format!(
                "an index below {} of a part without hinges",
                assembly.parts.len()
            )))
    }
}

/// State of one hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeState {
    /// Angle, radians, within half a turn.
    pub angle_rad: f64,
    /// Distance between the two anchor points that the hinge keeps together, metres; 0 for an ideal hinge.
    pub opening_m: f64,
    /// Angle between the two axes that the hinge keeps parallel, radians; 0 for an ideal hinge.
    pub tilt_rad: f64,
}

/// State of the robot at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Time, seconds from the start.
    pub time_s: f64,
    /// Parts, in the assembly's order.
    pub parts: Vec<PartState>,
    /// Hinges, in the assembly's order.
    pub hinges: Vec<HingeState>,
    /// Poses of the bodies of the scene, in the experiment's order.
    pub scene: Vec<Isometry3<f64>>,
}

impl Snapshot {
    pub(super) fn take(time_s: f64, assembly: &Assembly, world: &dyn World) -> Self {
        let parts: Vec<PartState> = (0..assembly.parts.len())
            .map(|part| world.part_state(part))
            .collect();
        let hinges = assembly
            .hinges
            .iter()
            .enumerate()
            .map(|(index, hinge)| {
                let held = |part: usize| {
                    let part_from_robot = robot_from_part_at_zero(assembly, part).inverse();
                    let anchor = part_from_robot * Point3::from(hinge.anchor_robot_m);
                    let pose = &parts[part].world_from_part;
                    (pose * anchor, pose * hinge.axis_robot.into_inner())
                };
                let (a, b) = (held(hinge.parent_part), held(hinge.child_part));
                HingeState {
                    angle_rad: world.hinge_angle_rad(index, 0.0),
                    opening_m: (a.0 - b.0).norm(),
                    tilt_rad: a.1.cross(&b.1).norm().atan2(a.1.dot(&b.1)),
                }
            })
            .collect();
        Self {
            time_s,
            parts,
            hinges,
            scene: world.scene_poses(),
        }
    }
}
