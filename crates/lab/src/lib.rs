//! Studies, predictions, searches and plans: what is done with a simulated robot and with recordings of the real one.

pub mod calibration;
pub mod claim;
pub mod plan;
pub mod prediction;
pub mod search;
