//! Tests of the crate: from an experiment to a run.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod amendment;
mod arena;
mod base;
mod bodies;
mod change;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod compensation;
mod compiled_motion;
mod compliance;
mod control;
mod energy;
mod engines;
mod export;
mod ground;
mod instrument;
mod noise_contract;
mod objects;
mod parameter_contract;
mod rest;
mod rolling;
mod run_parameters;
mod scene;
mod servo;
mod simulation;
mod stand;
mod turning;
mod vehicle;
mod wheels;
