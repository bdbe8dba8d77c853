//! A solver for trees of rigid links in reduced coordinates, with contact.
//!
//! A [`Model`] says what there is: links that hang on each other by joints, their shapes, fixtures, gravity. A [`World`] is built
//! from it and steps.
//!
//! One velocity solve per step, in these pieces:
//!
//! - `spatial`, `forest`, `kinematics`: vectors of six, trees depth first, poses and velocities (Featherstone, *Rigid Body Dynamics
//!   Algorithms*, 2008, chapters 2 to 4);
//! - `articulated`: the articulated-body algorithm on the level of impulses (chapter 7), which yields what every body gives to an
//!   impulse in a time proportional to the number of bodies;
//! - `collision`: what is close, by Parry, and corners of boxes on half-spaces;
//! - `contact`, `joint`: rows of contacts (soft normal, restitution, exact cone of friction) and of joints (servo, limit, dry
//!   friction);
//! - `sweep`: projected Gauss–Seidel over all rows, walking around each tree.
//!
//! Same model, same commands: same bits. After the first steps nothing is allocated but by Parry.

mod articulated;
mod collision;
mod contact;
mod forest;
mod joint;
mod kinematics;
mod model;
mod spatial;
mod step;
mod sweep;
mod touch;
mod world;

pub use joint::{Command, JointImpulse};
pub use model::{
    Attachment, Collider, Cone, Fixture, Joint, JointType, Link, Model, ModelError, Settings,
};
pub use parry3d_f64 as parry;
pub use world::{Contact, LinkState, Partner, World};
