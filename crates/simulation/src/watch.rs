//! A look at a whole robot during a run: every part and every hinge, not the tracked module alone.

use nalgebra::{Isometry3, Point3, Vector3};

use super::control::Feedback;
use super::engine::World;
use super::kinematics::robot_from_part_at_zero;
use super::part_state::PartState;
use realgap_core::error::{Error, Result};
use realgap_robot::morphology::Assembly;

/// Who sees every step, if anybody.
pub type Observer<'a> = Option<&'a mut dyn FnMut(&Snapshot)>;

/// Who attends a run; nobody unless said.
#[derive(Default)]
pub struct RunHooks<'a> {
    /// Sees every step as in [`watch`](super::run::watch); a vehicle has no parts to see.
    pub observer: Observer<'a>,
    /// Has the last word of every decision of a controller.
    pub feedback: Option<Feedback<'a>>,
    /// Hears before every step which share of the run is done, from 0 to 1; its error ends the run. A vehicle's run is over at once.
    pub clock: Option<&'a mut dyn FnMut(f64) -> Result<()>>,
}

impl RunHooks<'_> {
    /// Tells the clock that so many steps are done.
    pub(super) fn tell(&mut self, done: u64, steps: u64) -> Result<()> {
        match &mut self.clock {
            Some(clock) => clock(done as f64 / steps.max(1) as f64),
            None => Ok(()),
        }
    }
}

/// A velocity added to one loose part at time 0.
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
                "a part below {} that no hinge holds",
                assembly.parts.len()
            )))
    }
}

/// One hinge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeState {
    /// Angle, radians, within half a turn.
    pub angle_rad: f64,
    /// Distance between the two points that the hinge should keep together, metres.
    pub opening_m: f64,
    /// Angle between the two axes that the hinge should keep parallel, radians.
    pub tilt_rad: f64,
}

/// The robot at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Time, seconds from the start.
    pub time_s: f64,
    /// Parts, in the assembly's order.
    pub parts: Vec<PartState>,
    /// Hinges, in the assembly's order.
    pub hinges: Vec<HingeState>,
    /// Poses of the other bodies, in the experiment's order.
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
