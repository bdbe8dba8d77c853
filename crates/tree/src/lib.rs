//! A solver for trees of rigid links in reduced coordinates, with contact.
//!
//! A [`Model`] describes the system: links that are connected by joints, their shapes, fixtures, and gravity. A [`World`] is
//! built from a model and advances it step by step.
//!
//! Each step solves for the velocities once. The modules are:
//!
//! - `spatial`, `forest`, `kinematics`: vectors of six, trees depth first, poses and velocities (Featherstone, *Rigid Body Dynamics
//!   Algorithms*, 2008, chapters 2 to 4);
//! - `articulated`: the articulated-body algorithm on the level of impulses (chapter 7), which yields the response of every body
//!   to an impulse in a time proportional to the number of bodies;
//! - `collision`, `touch`: collision detection by Parry, and contacts of box corners with half-spaces;
//! - `contact`, `joint`: rows of contacts (soft normal, restitution, exact cone of friction) and of joints (servo, limit, dry
//!   friction);
//! - `mount`: a root on a spring; a mounted root may also be led ([`World::lead_root`]);
//! - `tyre`: friction that grows with the slip;
//! - `turning`: friction against rolling and spinning;
//! - `sweep`: projected Gauss–Seidel over all rows, walking around each tree.
//!
//! The same model and the same commands give bit-identical results. After the first steps no memory is allocated except by Parry.

mod articulated;
mod collision;
mod contact;
mod forest;
mod joint;
mod kinematics;
mod model;
mod mount;
mod spatial;
mod step;
mod sweep;
mod touch;
mod turning;
mod tyre;
mod world;

pub use joint::{Command, JointImpulse};
pub use model::{
    Attachment, Collider, Cone, Fixture, Joint, JointType, Link, Model, ModelError, Settings, Spot,
    SpotMap,
};
pub use mount::MountSpring;
pub use parry3d_f64 as parry;
pub use turning::TurningFriction;
pub use tyre::Tyre;
pub use world::{Contact, LinkState, Partner, World};
