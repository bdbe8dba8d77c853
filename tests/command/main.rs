//! Output and files of every command.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod apply;
mod cli;
#[path = "../common/mod.rs"]
mod common;
mod compare_time;
mod equal_runs;
mod foreign;
mod hint;
mod kept;
mod live;
mod new;
mod own_data;
mod pybullet;
mod start;
mod start_drive;
mod start_mujoco;
mod start_noise;
mod unnamed;
mod unused;
mod verify;
mod width;
