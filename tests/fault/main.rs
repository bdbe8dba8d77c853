//! Kills, damage, several machines: nothing is lost, and nothing is another without a word.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod crash;
mod fuzz;
mod interrupt;
mod plan;
mod seal;
mod slurm;
mod store;
