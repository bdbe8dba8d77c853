//! The door to the engines: what one has to do to simulate an experiment, and the list of those there are.

use std::fmt;

use nalgebra::{Isometry3, Vector3};

use super::experiment::{Experiment, JointState};
use super::motor::Effort;
use super::part_state::PartState;
use super::rapier::RAPIER;
use super::servo::Command;
use super::tree::TREE;
use realgap_core::error::Result;
use realgap_core::file::look_up;
use realgap_robot::morphology::Assembly;

/// What turns experiments into runs. [`run`](crate::run) owns commands, sampling and what is absurd; an engine owns time.
pub trait Engine: fmt::Debug + Sync {
    /// Name in files and on the command line.
    fn name(&self) -> &'static str;

    /// Version and precision, which decide the results bit for bit: part of fingerprints.
    fn version(&self) -> &'static str;

    /// Why it cannot simulate an experiment, as a whole sentence; then Rapier does, with a warning.
    fn refusal(&self, experiment: &Experiment) -> Option<String>;

    /// Puts a robot and what is around it into a world of the engine.
    ///
    /// # Errors
    /// A robot without inertia where it has to have some.
    fn build(&self, setup: &Setup<'_>) -> Result<Box<dyn World>>;
}

/// What a world is built from.
#[derive(Debug, Clone, Copy)]
pub struct Setup<'a> {
    /// Floor, scene, gravity, contacts and numerics.
    pub experiment: &'a Experiment,
    /// The robot with all adjustments: in place of the experiment's own.
    pub assembly: &'a Assembly,
    /// Where its parts start, by index: the pose of each part's frame.
    pub world_from_parts: &'a [Isometry3<f64>],
    /// Angles and speeds of its hinges at the start, by index.
    pub joints: &'a [JointState],
    /// How it moves as one rigid body at the start, beside its hinges.
    pub motion: Motion,
}

/// Rigid motion of a whole robot at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Point at which the linear velocity holds, world frame, metres.
    pub about_world_m: Vector3<f64>,
    /// Linear velocity of that point, world frame, m/s.
    pub linear_world_m_s: Vector3<f64>,
    /// Angular velocity, world frame, rad/s.
    pub angular_world_rad_s: Vector3<f64>,
}

impl Motion {
    /// No motion.
    pub const REST: Self = Self {
        about_world_m: Vector3::new(0.0, 0.0, 0.0),
        linear_world_m_s: Vector3::new(0.0, 0.0, 0.0),
        angular_world_rad_s: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// What one contact point did to one part of the robot during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Index of the part.
    pub part: usize,
    /// From the part's centre of mass to where the impulses act, world frame, metres.
    pub arm_world_m: Vector3<f64>,
    /// Impulse along the contact's normal, world frame, N s.
    pub normal_world_n_s: Vector3<f64>,
    /// Impulse across it, by friction, world frame, N s.
    pub friction_world_n_s: Vector3<f64>,
}

/// A robot on a floor in an engine's hands, one step at a time. Parts, hinges and bodies of the scene have the indices of the
/// assembly and of the experiment.
pub trait World {
    /// Advances by one timestep of the experiment.
    fn step(&mut self);

    /// Pose, linear velocity of the part frame's origin and angular velocity of a part, all in the world frame.
    fn part(&self, part: usize) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>);

    /// A part in full.
    fn part_state(&self, part: usize) -> PartState;

    /// A part in full, with the velocities that belong to the impulses of the last step.
    fn part_now(&self, part: usize) -> PartState {
        self.part_state(part)
    }

    /// Adds to the velocity of a part that no hinge holds, m/s.
    fn push(&mut self, part: usize, velocity_world_m_s: &Vector3<f64>);

    /// Angle of a hinge, radians, continued from `near_rad` so that it does not jump at half turns; of a slide metres.
    fn hinge_angle_rad(&self, hinge: usize, near_rad: f64) -> f64;

    /// Speed of a hinge, rad/s; of a slide m/s.
    fn hinge_speed_rad_s(&self, hinge: usize) -> f64;

    /// Asks the motor of a hinge that is at `angle_rad` to do `command` during the next step.
    fn drive(&mut self, hinge: usize, angle_rad: f64, command: Command);

    /// Has the motor of a hinge, and its gear, act during the next step.
    fn exert(&mut self, hinge: usize, effort: &Effort);

    /// Every contact of the step before, once for each part of the robot that it touches. Asked for only where
    /// [`Experiment::energy_from_s`] is stated.
    fn loads(&self, loads: &mut Vec<Load>);

    /// Where the bodies of the scene are.
    fn scene_poses(&self) -> Vec<Isometry3<f64>>;

    /// Puts a driven body of the scene where it starts.
    fn place_driven(&mut self, index: usize, world_from_body: &Isometry3<f64>);

    /// Leads a driven body to where it is to be after the next step.
    fn lead_driven(&mut self, index: usize, next: &Isometry3<f64>);
}

/// Which engine an experiment runs in: Rapier unless it says otherwise. Engines are told apart by their names.
#[derive(Clone, Copy)]
pub struct EngineChoice(&'static dyn Engine);

impl EngineChoice {
    /// Any engine, one of your own, too.
    pub const fn new(engine: &'static dyn Engine) -> Self {
        Self(engine)
    }

    /// The engine beside the reference: the tree solver, where it is built in.
    pub(super) fn second() -> Option<Self> {
        ENGINES.get(1).copied()
    }

    /// The engine.
    pub fn get(&self) -> &'static dyn Engine {
        self.0
    }

    /// The engine that will simulate an experiment: the chosen one, or Rapier with the sentence that says why.
    pub fn able(&self, experiment: &Experiment) -> (&'static dyn Engine, Option<String>) {
        match self.0.refusal(experiment) {
            None => (self.0, None),
            Some(why) => (&RAPIER, Some(why)),
        }
    }
}

impl Default for EngineChoice {
    fn default() -> Self {
        Self(&RAPIER)
    }
}

impl fmt::Debug for EngineChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name())
    }
}

impl PartialEq for EngineChoice {
    fn eq(&self, other: &Self) -> bool {
        self.0.name() == other.0.name()
    }
}

/// Every engine, the reference first.
pub static ENGINES: &[EngineChoice] = &[EngineChoice(&RAPIER), EngineChoice(&TREE)];

/// The engine of this name.
///
/// # Errors
/// No such engine; the error lists those there are.
pub fn engine_by_name(name: &str) -> Result<EngineChoice> {
    look_up("engine", name, ENGINES, |engine| engine.get().name()).copied()
}
