//! Pictures: what every extractor must do, agreement with scikit-image and scipy, known outlines, clean text, bad files.
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
