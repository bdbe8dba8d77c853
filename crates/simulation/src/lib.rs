//! Experiments and their simulation with a physics engine: Rapier, or the solver of the crate `realgap-tree`.
//!
//! An [`Experiment`] is plain data: robot, floor, start, duration, solver settings. [`run`] simulates it, returns a [`Run`], and
//! never changes the experiment. The same experiment gives bit-identical results, on any thread. Only the folder `rapier` names
//! the crate `rapier3d_f64`; all other files use the trait [`Engine`] or the types that `rapier` re-exports.

pub mod export;
pub mod parameter;

mod adjustment;
mod arena;
mod base;
mod camera;
mod command;
mod command_source;
mod control;
mod distribution;
mod energy;
mod engine;
mod experiment;
mod film;
mod foreign;
mod ground;
mod inertia;
mod instrument;
mod kinematics;
mod motor;
mod mount;
mod noise;
mod numerics;
mod outcome;
mod part_state;
mod path;
mod plausibility;
mod posture;
mod rapier;
mod rolling;
mod run;
mod scene;
mod servo;
mod settle;
mod simulator;
mod stiffness;
mod tree;
mod vehicle;
mod watch;

pub use adjustment::{Adjustment, HingeAdjustment, ModuleAdjustment};
pub use base::LedBase;
pub use camera::Camera;
pub use command::{Between, CommandTrack, Quantity};
#[cfg(feature = "schema")]
pub use control::ControllerFile;
pub use control::{
    Condition, Controller, Decision, Feedback, Heard, Log, Mounted, Other, Radio, Reads, Rule,
    Sensed, Steer,
};
pub use distribution::Distribution;
pub use energy::EnergyBalance;
pub use engine::{ENGINES, Engine, EngineChoice, Load, Motion, Setup, World, engine_by_name};
pub use experiment::{
    Contact, Experiment, Floor, FrictionModel, JointFormulation, JointState, LONGEST_S,
    Perturbation, Sampling, Solver, Start,
};
pub use film::{Film, film, film_with, part_from_solid, part_name};
pub use foreign::{Foreign, ForeignStart};
pub use ground::{read_arena, region_untouched};
pub use inertia::InertiaChange;
pub use instrument::{Instrument, Measured};
pub use motor::Effort;
pub use mount::Mount;
pub use noise::Noise;
pub use outcome::{Divergence, Outcome};
pub use part_state::PartState;
pub use posture::Posture;
pub use rapier::{ENGINE_VERSION, RAPIER, Rapier};
pub use realgap_sensing::arena::Ground;
pub use run::{Run, run, run_with, steer, watch};
pub use scene::{SceneBody, SceneBox, SceneMotion};
pub use servo::Command;
pub use settle::{Settling, settle};
pub use simulator::{BuiltIn, Simulator, SimulatorChoice};
pub use tree::{TREE, Tree};
#[cfg(feature = "schema")]
pub use vehicle::VehicleFile;
pub use vehicle::{Drive, Vehicle};
pub use watch::{HingeState, Observer, Push, RunHooks, Snapshot};
