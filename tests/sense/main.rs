//! Tests of the commands of `realgap sense`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../../crates/vision/tests/album.rs"]
mod album;
mod arena;
#[path = "../common/mod.rs"]
mod common;
mod comparison;
mod contract;
#[path = "../../crates/vision/tests/drawing.rs"]
mod drawing;
mod graph;
mod radio_command;
mod range;
mod ride;
#[path = "../../crates/sensing/tests/room.rs"]
mod room;
mod task;
mod walk;
mod watching;
