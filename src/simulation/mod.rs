//! Experiments and their simulation with Rapier.
//!
//! An [`Experiment`] is plain data: robot, floor, start, duration, solver settings. [`run`] turns
//! it into a [`Run`] and never changes it. Same experiment → same bits, on any thread.
//! `world` is the only file of the crate that names `rapier3d`.

mod experiment;
mod friction;
mod kinematics;
mod noise;
mod run;
mod servo;
mod settle;
mod watch;
mod world;

pub use experiment::{
    Adjustment, Contact, Experiment, Floor, FrictionModel, JointKind, Perturbation, Sampling,
    Solver, Start,
};
pub use noise::Noise;
pub use run::{Run, Status, run, watch};
pub use settle::{Settling, settle};
pub use watch::{HingeState, PartState, Push, Snapshot};
pub use world::ENGINE_VERSION;
