//! Trajectories: samples, formats, preparation and metrics. Nothing here knows that a simulator exists.

pub mod comparison;
pub mod trajectory;
