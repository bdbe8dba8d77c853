//! Trajectories: samples, file formats, preparation and metrics. This crate does not depend on any simulator.

pub mod comparison;
pub mod trajectory;
