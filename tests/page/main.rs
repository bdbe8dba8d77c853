//! Pages, replays and pictures.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod contract;
mod gallery;
mod legible;
mod pages;
mod replay;
mod replay_file;
mod report;
