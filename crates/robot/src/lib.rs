//! Robot models: the types that describe a robot, and how they are read from files and written to files.
//!
//! [`morphology`] is the robot itself, a tree of modules or bodies that is parsed from RON; [`genome`] holds ten numbers per
//! module, from which *development* builds a robot; [`import`] reads URDF and MJCF.

pub mod genome;
pub mod import;
pub mod morphology;
