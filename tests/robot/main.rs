//! Robots in the commands: made, developed, exported, imported, searched.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod develop;
mod export;
mod finalists;
mod ground;
mod import;
mod robot_search;
