//! Tests of the crate: robots of modules and of bodies, genomes, and the import of URDF and MJCF.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod amendment;
mod amendment_ron;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod compiled;
mod foreign;
mod genome;
mod limits;
mod morphology;
mod surroundings;
mod urdf;
