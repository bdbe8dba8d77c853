//! Tests of feature extractors, simulated cameras and comparisons of pictures.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/validation/vision.md"
)]

mod album;
mod camera;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod company;
mod comparison;
mod contract;
mod drawing;
mod golden;
mod outline;
mod program;
mod reading;
mod ride;
mod tuning;
mod unreadable;
