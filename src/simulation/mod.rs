//! Experiments and their simulation with Rapier.
//!
//! An [`Experiment`] is plain data: robot, floor, start, duration, solver settings. [`run`] turns
//! it into a [`Run`] and never changes it. Same experiment → same bits, on any thread.
//! `engine` is the only file of the crate that names `rapier3d`, in f64 or (feature `f32`) in f32.

pub mod parameter;
pub mod verification;

mod camera;
mod distribution;
mod engine;
mod experiment;
mod friction;
mod kinematics;
mod noise;
mod outcome;
mod part_state;
mod plausibility;
mod posture;
mod run;
mod servo;
mod settle;
mod watch;
mod world;

pub use camera::Camera;
pub use distribution::Distribution;
pub use engine::ENGINE_VERSION;
pub use experiment::{
    Adjustment, Contact, Experiment, Floor, FrictionModel, JointKind, Perturbation, Sampling,
    Solver, Start,
};
pub use noise::Noise;
pub use outcome::{Divergence, Outcome};
pub use part_state::PartState;
pub use posture::Posture;
pub use run::{Run, run, watch};
pub use settle::{Settling, settle};
pub use watch::{HingeState, Push, Snapshot};
