//! Robots: what is built, and how it is written down.
//!
//! [`morphology`] is the robot itself, a tree of modules parsed from RON; [`genome`] is ten numbers a module, from which
//! *development* builds one.

pub mod genome;
pub mod import;
pub mod morphology;
