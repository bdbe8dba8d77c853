//! Interface of physics engines: the trait that an engine implements, and the list of all engines.

use std::fmt;

use nalgebra::{Isometry3, Vector3};

use super::experiment::{Experiment, JointFormulation, JointState};
use super::motor::Effort;
use super::part_state::PartState;
use super::rapier::RAPIER;
use super::servo::Command;
use super::stiffness::rapier_follows;
use super::tree::TREE;
use realgap_core::error::Result;
use realgap_core::file::look_up;
use realgap_robot::morphology::Assembly;

/// A physics engine. [`run`](crate::run) computes commands, takes samples and detects diverged states; the engine advances the
/// time.
pub trait Engine: fmt::Debug + Sync {
    /// Name of the engine in files and on the command line.
    fn name(&self) -> &'static str;

    /// Version and precision, which determine the results bit for bit; they are part of fingerprints.
    fn version(&self) -> &'static str;

    /// Reason why the engine cannot simulate an experiment, as a whole sentence; Rapier then simulates it instead, with a
    /// warning.
    fn refusal(&self, experiment: &Experiment) -> Option<String>;

    /// Builds a world of the engine that contains a robot and the scene.
    ///
    /// # Errors
    /// A robot with a part that has no inertia although it needs one.
    fn build(&self, setup: &Setup<'_>) -> Result<Box<dyn World>>;
}

/// Everything that a world is built from.
#[derive(Debug, Clone, Copy)]
pub struct Setup<'a> {
    /// Floor, scene, gravity, contacts and numerics.
    pub experiment: &'a Experiment,
    /// The robot with all adjustments, which replaces the experiment's own robot.
    pub assembly: &'a Assembly,
    /// Poses of the parts' frames at the start, by index.
    pub world_from_parts: &'a [Isometry3<f64>],
    /// Angles and speeds of its hinges at the start, by index.
    pub joints: &'a [JointState],
    /// Rigid motion of the whole robot at the start, in addition to that of its hinges.
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
    pub(crate) const REST: Self = Self {
        about_world_m: Vector3::new(0.0, 0.0, 0.0),
        linear_world_m_s: Vector3::new(0.0, 0.0, 0.0),
        angular_world_rad_s: Vector3::new(0.0, 0.0, 0.0),
    };
}

/// Impulses of one contact point on one part of the robot during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Index of the part.
    pub part: usize,
    /// Vector from the part's centre of mass to the point at which the impulses act, world frame, metres.
    pub arm_world_m: Vector3<f64>,
    /// Impulse along the contact's normal, world frame, N s.
    pub normal_world_n_s: Vector3<f64>,
    /// Friction impulse, perpendicular to the normal, world frame, N s.
    pub friction_world_n_s: Vector3<f64>,
    /// Angular impulse against rolling and spinning, world frame, N m s.
    pub couple_world_n_m_s: Vector3<f64>,
}

/// A simulated world of an engine, with one robot. Parts, hinges and bodies of the scene have the indices of the assembly and of
/// the experiment.
pub trait World {
    /// Advances by one timestep of the experiment.
    fn step(&mut self);

    /// Pose, linear velocity of the part frame's origin and angular velocity of a part, all in the world frame.
    fn part(&self, part: usize) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>);

    /// Complete state of a part.
    fn part_state(&self, part: usize) -> PartState;

    /// Complete state of a part, with the velocities after the impulses of the last step.
    fn part_now(&self, part: usize) -> PartState {
        self.part_state(part)
    }

    /// Adds to the velocity of a part without hinges, m/s.
    fn push(&mut self, part: usize, velocity_world_m_s: &Vector3<f64>);

    /// Angle of a hinge, radians, continued from `near_rad` so that it does not jump at half turns; for a slide the distance,
    /// metres.
    fn hinge_angle_rad(&self, hinge: usize, near_rad: f64) -> f64;

    /// Speed of a hinge, rad/s; for a slide m/s.
    fn hinge_speed_rad_s(&self, hinge: usize) -> f64;

    /// Sets the command of the motor of a hinge, which is at `angle_rad`, for the next step.
    fn drive(&mut self, hinge: usize, angle_rad: f64, command: Command);

    /// Applies the effort of the motor and the gear of a hinge during the next step.
    fn exert(&mut self, hinge: usize, effort: &Effort);

    /// Mean torque of a hinge's motor during the previous step, on the child, N m (for a slide its force, N), in an engine that
    /// computes it; known only where the experiment has [instruments](Experiment::instruments).
    fn motor_torque_nm(&self, hinge: usize) -> Option<f64> {
        let _ = hinge;
        None
    }

    /// All contacts of the previous step, once for each part of the robot that is in contact. Called only if
    /// [`Experiment::energy_from_s`] is stated.
    fn loads(&self, loads: &mut Vec<Load>);

    /// Poses of the bodies of the scene.
    fn scene_poses(&self) -> Vec<Isometry3<f64>>;

    /// Leads the robot's root, in an engine that can, so that it reaches a pose after the next step. An engine that cannot refuses
    /// experiments with a [base](Experiment::base).
    fn lead_base(&mut self, next: &Isometry3<f64>) {
        let _ = next;
    }

    /// Whether a contact with an impulse touched each region of the ground up to now; empty in an engine that does not know.
    fn touched_regions(&self) -> &[bool] {
        &[]
    }

    /// Places a driven body of the scene at its start pose.
    fn place_driven(&mut self, index: usize, world_from_body: &Isometry3<f64>);

    /// Moves a driven body so that it reaches a pose after the next step.
    fn lead_driven(&mut self, index: usize, next: &Isometry3<f64>);
}

/// The engine that simulates an experiment: Rapier by default. Engines are compared by their names.
#[derive(Clone, Copy)]
pub struct EngineChoice(&'static dyn Engine);

impl EngineChoice {
    /// Any engine, including one that is implemented outside of this crate.
    pub const fn new(engine: &'static dyn Engine) -> Self {
        Self(engine)
    }

    /// The engine for a robot whose file and user choose none: the tree solver for a robot with tyres or with rolling or torsional
    /// friction, and for a robot of bodies with more than [`JointFormulation::MOST_HINGES`] joints or with a spring that Rapier would
    /// make softer, else Rapier. Such a long robot has multibody joints in Rapier, whose cost grows with the cube of the number of
    /// joints, and in the tree solver in proportion to it (docs/design.md).
    pub fn suited_to(assembly: &Assembly) -> Self {
        let is_long = !assembly.is_modular
            && assembly.hinges.len() > JointFormulation::MOST_HINGES
            && !assembly.is_compliant();
        let is_stiff =
            !assembly.is_modular && !assembly.is_compliant() && !rapier_follows(assembly);
        match is_long || is_stiff || assembly.has_tyres() || assembly.states_turning_friction() {
            true => Self(&TREE),
            false => Self::default(),
        }
    }

    /// The second engine besides the reference: the tree solver, if it is in the list.
    pub(super) fn second() -> Option<Self> {
        ENGINES.get(1).copied()
    }

    /// The engine.
    pub fn get(&self) -> &'static dyn Engine {
        self.0
    }

    /// The engine that will simulate an experiment: the chosen one, or Rapier (the tree solver for a mount with a spring and for a base
    /// that is led) together with the reason why the chosen engine cannot.
    pub fn able(&self, experiment: &Experiment) -> (&'static dyn Engine, Option<String>) {
        match self.0.refusal(experiment) {
            None => (self.0, None),
            // Rapier has every kind of joint, but no mount with a spring, no base that is led, no tyres, and no rolling friction.
            Some(why) if RAPIER.refusal(experiment).is_some() => (&TREE, Some(why)),
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
/// An unknown engine; the error lists the known ones.
pub fn engine_by_name(name: &str) -> Result<EngineChoice> {
    look_up("engine", name, ENGINES, |engine| engine.get().name()).copied()
}
