//! The experiment: all settings that determine a simulation, as plain data.

mod check;

pub use check::LONGEST_S;

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};

use super::adjustment::{Adjustment, HingeAdjustment, ModuleAdjustment};
use super::base::LedBase;
use super::command::CommandTrack;
use super::control::Controller;
use super::engine::{Engine, EngineChoice};
use super::foreign::Foreign;
use super::instrument::Instrument;
use super::mount::Mount;
use super::scene::SceneBody;
use super::simulator::SimulatorChoice;
use super::vehicle::{Drive, Vehicle};
use realgap_core::error::Result;
use realgap_core::unit::GRAVITY_M_S2;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::body::Surroundings;
use realgap_robot::morphology::{Assembly, Role};
use realgap_sensing::arena::Ground;

/// The ground: a half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// Coulomb friction coefficient of the pair robot–floor, dimensionless.
    pub friction: f64,
    /// Restitution coefficient of the pair robot–floor, dimensionless, 0 to 1.
    pub restitution: f64,
    /// Rolling friction of the floor, metres: the largest couple against rolling over the normal force, to which a shape's own is
    /// added. A value, 0 included, needs the tree solver, so that all values of a range are of one engine.
    pub rolling_m: Option<f64>,
    /// Torsional friction of the floor, metres: as the rolling friction, against spinning about the normal.
    pub torsional_m: Option<f64>,
    /// Height of the floor at the world origin, metres.
    pub height_m: f64,
    /// Slope about the world y axis, radians; positive: downhill towards +x.
    pub slope_rad: f64,
}

impl Default for Floor {
    fn default() -> Self {
        Self {
            friction: 0.5,
            restitution: 0.1,
            rolling_m: None,
            torsional_m: None,
            height_m: 0.0,
            slope_rad: 0.0,
        }
    }
}

impl Floor {
    /// The floor that a robot's file states; what it does not state is the default.
    fn around(world: &Surroundings) -> Self {
        let usual = Self::default();
        Self {
            friction: world.floor_friction.unwrap_or(usual.friction),
            rolling_m: world.floor_rolling_m,
            torsional_m: world.floor_torsional_m,
            height_m: world.floor_height_m.unwrap_or(usual.height_m),
            slope_rad: world.floor_slope_rad.unwrap_or(usual.slope_rad),
            ..usual
        }
    }

    /// The floor's upward unit normal in the world frame.
    pub fn normal_world(&self) -> Vector3<f64> {
        Vector3::new(self.slope_rad.sin(), 0.0, self.slope_rad.cos())
    }
}

/// State of the robot at time 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// The robot is placed on the floor at the origin with the servos at their first command, and settles before time 0.
    Settled,
    /// The full state of the tracked module, in recorded lengths ([`Experiment::recording_length_scale`]); the joints start as
    /// [`Experiment::start_joints`] states.
    State(State),
}

/// Angle and speed of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Angle, radians.
    pub angle_rad: f64,
    /// Speed, rad/s.
    pub speed_rad_s: f64,
}

/// Formulation of joints in the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointFormulation {
    /// Reduced coordinates: hinges cannot separate.
    Multibody,
    /// Maximal coordinates: hinges are constraints that are solved together with the contacts, which is faster.
    Impulse,
    /// Multibody joints for a robot with at most [`JointFormulation::MOST_HINGES`] hinges in which a light part carries a heavy
    /// one ([`JointFormulation::LIGHT`]) or a servo is a motor behind a gear; impulse joints for all other modular robots,
    /// because multibody joints soften contacts (docs/validation/contact.md). A robot of bodies always has multibody joints, and a
    /// robot with compliant bearings always has impulse joints.
    Auto,
}

impl JointFormulation {
    /// Largest number of hinges for which [`JointFormulation::Auto`] chooses multibody joints: their cost grows with the square
    /// of the number of hinges or faster.
    pub const MOST_HINGES: usize = 12;
    /// A part counts as light if its mass is below this fraction of the mass of the part that it is hinged to.
    pub const LIGHT: f64 = 0.25;

    /// The formulation for this robot: never [`JointFormulation::Auto`].
    pub fn resolved(self, assembly: &Assembly) -> Self {
        let mass_kg = |part: usize| assembly.parts[part].mass_kg();
        let is_uneven = assembly.hinges.iter().any(|hinge| {
            let (a, b) = (mass_kg(hinge.parent_part), mass_kg(hinge.child_part));
            let has_gear = hinge
                .actuator
                .is_some_and(|actuator| actuator.servo.law.motor().is_some());
            has_gear || a.min(b) < Self::LIGHT * a.max(b)
        });
        match self {
            // Multibody joints cannot be compliant.
            Self::Auto if assembly.is_compliant() => Self::Impulse,
            // Links without mass, springs and slides are represented best in reduced coordinates.
            Self::Auto if !assembly.is_modular => Self::Multibody,
            Self::Auto if is_uneven && assembly.hinges.len() <= Self::MOST_HINGES => {
                Self::Multibody
            }
            Self::Auto => Self::Impulse,
            chosen => chosen,
        }
    }

    /// The other formulation for the same robot.
    pub fn other(self) -> Self {
        match self {
            Self::Impulse => Self::Multibody,
            Self::Multibody | Self::Auto => Self::Impulse,
        }
    }
}

/// Friction models: Rapier has the first two, the tree solver the last two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionModel {
    /// One friction pyramid and twist per manifold.
    Simplified,
    /// A friction cone at every contact point, opposite to its slip.
    Coulomb,
    /// A cone that is relaxed to a convex problem, as MuJoCo's is (Anitescu 2006; Todorov 2014): sliding bodies hop over the
    /// floor.
    Relaxed,
}

/// Contact model of the solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Distance at which contacts are predicted, metres.
    pub prediction_m: f64,
    /// Natural frequency of contacts with the floor, Hz; contacts between modules have half of it, as in Rapier's own defaults
    /// (60 and 30 Hz).
    pub natural_frequency_hz: f64,
    /// Damping ratio of the contact softness, dimensionless.
    pub damping_ratio: f64,
    /// Friction model.
    pub friction_model: FrictionModel,
    /// Whether anything touches the robot; off, it passes through floor, scene and itself.
    pub is_on: bool,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            prediction_m: 0.002,
            natural_frequency_hz: 300.0,
            damping_ratio: 3.0,
            friction_model: FrictionModel::Coulomb,
            is_on: true,
        }
    }
}

/// Numerical settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// Time per step, seconds.
    pub timestep_s: f64,
    /// Solver substeps per step.
    pub substeps: usize,
    /// Passes over joints and contacts in every substep (Rapier's "internal PGS iterations").
    pub sweeps: usize,
    /// Passes without bias at the end of every substep (Rapier's "internal stabilization iterations"). With 0 the energy of
    /// hinges is conserved; every such pass dissipates some of it (docs/validation/joints.md).
    pub relaxations: usize,
    /// Formulation of joints in Rapier.
    pub joint: JointFormulation,
    /// The engine that simulates.
    pub engine: EngineChoice,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            timestep_s: 1.0 / 480.0,
            substeps: 3,
            sweeps: 4,
            relaxations: 0,
            joint: JointFormulation::Auto,
            engine: EngineChoice::default(),
        }
    }
}

/// Timestep (s) and natural frequency of contacts (Hz) for [`Experiment::relaxed`]: the angular frequency is the inverse of 2 ms.
const RELAXED_STEP_S: f64 = 1.0 / 2000.0;
const RELAXED_HZ: f64 = 500.0 / std::f64::consts::TAU;
/// Damping ratio and number of sweeps for [`Experiment::at_limit`].
const LIMIT_DAMPING_RATIO: f64 = 3.0;
const LIMIT_SWEEPS: usize = 4;

/// Deviations of one repeat from the intended experiment, as drawn from the noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    /// Shift of the start, world frame, metres. A settled start changes it while the robot falls and settles.
    pub shift_world_m: Vector3<f64>,
    /// Rotation of the start about the tracked point, world frame, rotation vector, radians.
    pub turn_world_rad: Vector3<f64>,
    /// Velocity added to that of a stated start, world frame, m/s. It has no effect on a settled start.
    pub velocity_world_m_s: Vector3<f64>,
    /// Angular velocity added to that of a stated start, world frame, rad/s.
    pub spin_world_rad_s: Vector3<f64>,
    /// Error of every servo's zero, radians, by hinge; empty for none.
    pub servo_zero_rad: Vec<f64>,
    /// Factor on every servo's gain, by hinge; empty for none.
    pub servo_gain_factor: Vec<f64>,
    /// Error of every command's phase, radians, by hinge; empty for none.
    pub servo_phase_rad: Vec<f64>,
    /// Latency of every servo in addition to the adjustment's, seconds, by hinge; empty for none.
    pub servo_latency_s: Vec<f64>,
    /// Factor on every module's mass, by module; empty for none.
    pub mass_factor: Vec<f64>,
    /// Factor on every module's friction, by module; empty for none.
    pub friction_factor: Vec<f64>,
    /// Additional factor on the friction of every module's plate, by module; empty for none.
    pub plate_friction_factor: Vec<f64>,
    /// Factor on the friction of all modules.
    pub run_friction_factor: f64,
    /// Seed and number of the repeat, for models that draw random numbers during the run (wheels and sensor of a vehicle, sensors
    /// of a controller); `None` for a run without noise.
    pub draw: Option<(u64, u64)>,
}

impl Default for Perturbation {
    /// No deviation.
    fn default() -> Self {
        Self {
            shift_world_m: Vector3::zeros(),
            turn_world_rad: Vector3::zeros(),
            velocity_world_m_s: Vector3::zeros(),
            spin_world_rad_s: Vector3::zeros(),
            servo_zero_rad: Vec::new(),
            servo_gain_factor: Vec::new(),
            servo_phase_rad: Vec::new(),
            servo_latency_s: Vec::new(),
            mass_factor: Vec::new(),
            friction_factor: Vec::new(),
            plate_friction_factor: Vec::new(),
            run_friction_factor: 1.0,
            draw: None,
        }
    }
}

impl Perturbation {
    /// Friction of a module's cube or plate as a factor on the floor's parameter.
    pub fn friction_factor_of(&self, module: usize, role: Role) -> f64 {
        let of = |factors: &[f64]| factors.get(module).copied().unwrap_or(1.0);
        let module_factor = of(&self.friction_factor) * self.run_friction_factor;
        match role {
            Role::Cube => module_factor,
            Role::Plate => module_factor * of(&self.plate_friction_factor),
        }
    }

    /// Latency of a servo in addition to the adjustment's, seconds.
    pub(crate) fn latency_s_of(&self, hinge: usize) -> f64 {
        self.servo_latency_s.get(hinge).copied().unwrap_or(0.0)
    }
}

/// Times at which the state is recorded.
#[derive(Debug, Clone, PartialEq)]
pub enum Sampling {
    /// At this rate, Hz, from time 0, and at the end.
    Rate(f64),
    /// At these times, seconds from the start, increasing.
    Times(Arc<[f64]>),
}

/// One execution of a robot that is to be simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The robot.
    pub assembly: Arc<Assembly>,
    /// The ground.
    pub floor: Floor,
    /// Magnitude of gravity along −z of the world, m/s².
    pub gravity_m_s2: f64,
    /// State at time 0.
    pub start: Start,
    /// Joints at time 0, by hinge. A hinge without a value starts at its servo's first command, or at 0 if it is passive, with
    /// speed 0. A settled start uses the angles as the state before settling.
    pub start_joints: Vec<JointState>,
    /// Whether the run's trajectory also contains the angles and speeds of the joints; by default it does if the robot's file
    /// states hinges.
    pub records_joints: bool,
    /// Sensors that the run's trajectory contains beside pose and joints, as signals.
    pub instruments: Vec<Instrument>,
    /// Recorded commands of servos, in place of their gaits, by name of the hinge.
    pub commands: BTreeMap<String, Arc<CommandTrack>>,
    /// What simulates: the engines of this crate, or a simulator of somebody else.
    pub simulator: SimulatorChoice,
    /// What a simulator of somebody else is asked; empty for the engines of this crate.
    pub foreign: Foreign,
    /// A two-wheel robot that replaces the robot of the assembly, which then only provides the size.
    pub vehicle: Option<Arc<Vehicle>>,
    /// Parameters of the two-wheel robot.
    pub drive: Drive,
    /// Controller of the robot: sensors, rules and radio ([`Experiment::with_controller`]).
    pub controller: Option<Arc<Controller>>,
    /// Other bodies in the scene.
    pub scene: Vec<SceneBody>,
    /// Regions of the floor, steps and a height field, in the floor's own frame ([`Floor::world_from_floor`]).
    pub ground: Ground,
    /// Factor on the heights of the height field.
    pub heights_scale: f64,
    /// Length of the run, seconds.
    pub duration_s: f64,
    /// Times at which the state is recorded.
    pub sampling: Sampling,
    /// The spring by which a held robot is held; `None`: it is held rigidly.
    pub mount: Option<Mount>,
    /// The motion along which the robot's root is led, as if it were held by something that moves ([`Experiment::lead_base`]).
    pub base: Option<Arc<LedBase>>,
    /// Numerical settings.
    pub solver: Solver,
    /// Contact model.
    pub contact: Contact,
    /// Changes to the robot.
    pub adjustment: Adjustment,
    /// Changes to single joints, by hinge; empty for none.
    pub hinge_adjustments: Vec<HingeAdjustment>,
    /// Changes to single modules, by name.
    pub module_adjustments: BTreeMap<String, ModuleAdjustment>,
    /// Deviations from the intended experiment.
    pub perturbation: Perturbation,
    /// Name of the recording of this run, where parameters differ between runs ([`super::parameter::run_name`]).
    pub run: Option<Arc<str>>,
    /// Ratio of recorded to true lengths. The run itself is in true lengths.
    pub recording_length_scale: f64,
    /// If stated, the run computes its energy balance ([`super::EnergyBalance`]) from this time on, seconds. This does not change
    /// the run.
    pub energy_from_s: Option<f64>,
}

impl Experiment {
    /// An experiment with all defaults: settled start, 10 s, 60 samples per second, the engine that suits the robot
    /// ([`EngineChoice::suited_to`]), and the world that the robot's file states around it.
    pub fn new(assembly: Assembly) -> Self {
        let around = &assembly.surroundings;
        let usual = Solver::default();
        let solver = Solver {
            engine: EngineChoice::suited_to(&assembly),
            timestep_s: (around.timestep_s)
                .map_or(usual.timestep_s, |most_s| most_s.min(usual.timestep_s)),
            ..usual
        };
        let floor = Floor::around(around);
        let gravity_m_s2 = around.gravity_m_s2.unwrap_or(GRAVITY_M_S2);
        let scene = around.bodies.iter().map(SceneBody::beside).collect();
        Self {
            records_joints: assembly.hinges.iter().any(|hinge| hinge.is_stated),
            assembly: Arc::new(assembly),
            floor,
            gravity_m_s2,
            start: Start::Settled,
            start_joints: Vec::new(),
            instruments: Vec::new(),
            commands: BTreeMap::new(),
            simulator: SimulatorChoice::default(),
            foreign: Foreign::default(),
            vehicle: None,
            drive: Drive::default(),
            controller: None,
            scene,
            ground: Ground::default(),
            heights_scale: 1.0,
            duration_s: 10.0,
            sampling: Sampling::Rate(60.0),
            mount: None,
            base: None,
            solver,
            contact: Contact::default(),
            adjustment: Adjustment::default(),
            hinge_adjustments: Vec::new(),
            module_adjustments: BTreeMap::new(),
            perturbation: Perturbation::default(),
            run: None,
            recording_length_scale: 1.0,
            energy_from_s: None,
        }
    }

    /// Has the robot's root follow the poses of a recording of the tracked body, whether or not its file holds the root; nothing
    /// hinders that motion. A robot whose tracked body is not its root is refused when the experiment is checked.
    ///
    /// # Errors
    /// As [`LedBase::new`].
    pub fn lead_base(&mut self, recorded: &Trajectory) -> Result<()> {
        let base = LedBase::new(recorded)?;
        let assembly = Arc::make_mut(&mut self.assembly);
        assembly
            .world_from_mount
            .get_or_insert_with(Isometry3::identity);
        self.base = Some(Arc::new(base));
        Ok(())
    }

    /// The engine that will simulate this experiment: the chosen one, or Rapier if the chosen engine cannot.
    pub fn engine(&self) -> &'static dyn Engine {
        self.solver.engine.able(self).0
    }

    /// Name and version of what simulates this experiment: an engine, the equations of a vehicle, or a simulator of somebody else.
    pub fn engine_version(&self) -> &'static str {
        self.simulator.get().version(self)
    }

    /// Whether an engine of this crate simulates the experiment, so that its numerics, contacts and joints can be changed. A
    /// vehicle and a simulator of somebody else have none.
    pub fn has_engine(&self) -> bool {
        self.vehicle.is_none() && self.simulator.is_built_in()
    }

    /// A second engine that is as valid for this experiment as Rapier: the tree solver. `None` if the tree solver cannot simulate
    /// the experiment, or if the experiment uses settings that exist only in Rapier (impulse joints, relaxations, simplified
    /// friction) or a third engine.
    pub fn second_engine(&self) -> Option<EngineChoice> {
        let (solver, second) = (&self.solver, EngineChoice::second()?);
        let plain = solver.joint != JointFormulation::Impulse
            && solver.relaxations == 0
            && self.contact.friction_model == FrictionModel::Coulomb;
        let is_known = [EngineChoice::default(), second].contains(&solver.engine);
        // There is no second opinion about what one of both engines cannot simulate.
        let mut both = [EngineChoice::default(), second].into_iter();
        let can = self.has_engine() && both.all(|engine| engine.get().refusal(self).is_none());
        (plain && is_known && can).then_some(second)
    }

    /// Whether contacts have friction against rolling or spinning, which only the tree solver simulates.
    pub fn has_turning_friction(&self) -> bool {
        let floor = &self.floor;
        let is_stated = floor.rolling_m.is_some()
            || floor.torsional_m.is_some()
            || self.assembly.has_turning_shapes();
        is_stated && self.contact.is_on && self.vehicle.is_none()
    }

    /// Formulation of joints for this robot: never [`JointFormulation::Auto`].
    pub fn joint_kind(&self) -> JointFormulation {
        self.solver.joint.resolved(&self.assembly)
    }

    /// The same experiment near the limit of rigid contact and short steps, with this formulation of joints; such a run is slow.
    /// Results that change much towards this limit are dominated by numerical effects (docs/validation.md).
    pub fn at_limit(&self, joint: JointFormulation) -> Self {
        let joint = joint.resolved(&self.assembly);
        let mut limit = self.clone();
        limit.solver.joint = joint;
        limit.solver.timestep_s *= 0.25;
        limit.solver.sweeps = limit.solver.sweeps.max(LIMIT_SWEEPS);
        // With impulse joints the effective mass at a contact is that of a single part, so contacts need a higher frequency and
        // more substeps.
        let (frequency_hz, substeps) = match joint {
            JointFormulation::Impulse => (1200.0, 8),
            JointFormulation::Multibody | JointFormulation::Auto => (600.0, 1),
        };
        limit.solver.substeps = limit.solver.substeps.max(substeps);
        let contact = &mut limit.contact;
        contact.natural_frequency_hz = contact.natural_frequency_hz.max(frequency_hz);
        contact.damping_ratio = contact.damping_ratio.min(LIMIT_DAMPING_RATIO);
        limit
    }

    /// The same experiment with contacts like those of MuJoCo for a file that [`export`](crate::export) writes (`solref` 0.002
    /// 1): a relaxed cone, and a spring and damper with a time constant of 2 ms, in the tree solver. `None` if the tree solver
    /// cannot simulate the experiment.
    pub fn relaxed(&self) -> Option<Self> {
        let mut relaxed = self.clone();
        relaxed.solver.engine = self.second_engine()?;
        (relaxed.solver.timestep_s, relaxed.solver.substeps) = (RELAXED_STEP_S, 1);
        relaxed.contact = Contact {
            natural_frequency_hz: RELAXED_HZ,
            damping_ratio: 1.0,
            friction_model: FrictionModel::Relaxed,
            ..self.contact
        };
        Some(relaxed)
    }

    /// Adjustment of a joint and its servo.
    pub fn hinge_adjustment(&self, hinge: usize) -> HingeAdjustment {
        let changed = self.hinge_adjustments.get(hinge);
        changed.copied().unwrap_or_default()
    }

    /// The robot with the adjustments applied.
    pub fn adjusted_assembly(&self) -> Assembly {
        let mut robot = self.adjustment.apply(&self.assembly);
        for (hinge, change) in robot.hinges.iter_mut().zip(&self.hinge_adjustments) {
            if let Some(actuator) = &mut hinge.actuator {
                actuator.servo.law.scale_gain(change.gain_scale);
            }
        }
        for (name, module) in &self.module_adjustments {
            module.apply(name, &mut robot);
        }
        self.perturb(&mut robot);
        robot
    }

    /// Applies the deviations of this repeat to the robot.
    fn perturb(&self, robot: &mut Assembly) {
        let drawn = &self.perturbation;
        for solid in robot.parts.iter_mut().flat_map(|part| &mut part.solids) {
            let factor = drawn.mass_factor.get(solid.module).unwrap_or(&1.0);
            solid.mass_kg *= factor;
            solid.inertia_kg_m2 *= *factor;
        }
        for (index, hinge) in robot.hinges.iter_mut().enumerate() {
            let Some(actuator) = &mut hinge.actuator else {
                continue;
            };
            let of = |draws: &[f64]| draws.get(index).copied();
            if let Some(zero_rad) = of(&drawn.servo_zero_rad) {
                actuator.gait.offset_rad += zero_rad;
            }
            if let Some(phase_rad) = of(&drawn.servo_phase_rad) {
                actuator.gait.phase_rad += phase_rad;
            }
            if let Some(factor) = of(&drawn.servo_gain_factor) {
                actuator.servo.law.scale_gain(factor);
            }
        }
    }

    /// Sample times, seconds from the start, at least two.
    pub fn sample_times_s(&self) -> Vec<f64> {
        match &self.sampling {
            Sampling::Times(times_s) => times_s.to_vec(),
            Sampling::Rate(hz) => {
                let last = (self.duration_s * hz + 1e-9).floor() as usize;
                let mut times_s: Vec<f64> = (0..=last).map(|k| k as f64 / hz).collect();
                let end = times_s[last];
                if self.duration_s - end > 1e-9 {
                    times_s.push(self.duration_s);
                }
                times_s
            }
        }
    }
}
