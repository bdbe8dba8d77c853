//! Kills, damage, several machines: nothing is lost, and nothing is another without a word.

#[path = "../common/mod.rs"]
mod common;
mod crash;
mod fuzz;
mod interrupt;
mod plan;
mod slurm;
mod store;
