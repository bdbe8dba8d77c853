//! Studies: sweeps, tuning, ensembles, gaps, predictions.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod basis;
#[path = "../../crates/simulation/tests/change.rs"]
mod change;
#[path = "../common/mod.rs"]
mod common;
#[path = "../../crates/lab/tests/elbow.rs"]
mod elbow;
mod forecast;
mod gap_command;
mod in_sample;
mod jointed;
mod library;
mod model_error;
mod noise_floor;
mod servo;
mod simulator;
#[path = "../../crates/lab/tests/toss/standin.rs"]
mod standin;
mod sweep;
mod toss;
mod tune;
mod vehicle;
