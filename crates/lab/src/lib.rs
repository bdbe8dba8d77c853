//! What is found out: calibration, prediction, search, and plans that spread them over machines.

pub mod calibration;
pub mod claim;
pub mod plan;
pub mod prediction;
pub mod search;
