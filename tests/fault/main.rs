//! Kills, damage and several machines: no results are lost, and no change of results goes unnoticed.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod corpus;
mod crash;
mod extreme;
mod fuzz;
mod interrupt;
mod plan;
mod seal;
mod slurm;
mod store;
