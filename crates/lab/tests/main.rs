//! Calibration, prediction and search, without the command line.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod basis;
mod between;
mod carried;
mod channels;
mod columns;
mod commanded;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod confidence;
mod coverage;
mod determination;
mod elbow;
mod engines;
mod ensemble;
mod fleet;
mod gains;
mod gap;
mod ground;
mod in_sample;
mod joint_log;
mod jointed;
mod led_base;
mod misfit;
mod model_error;
mod noise;
mod odds;
mod payload;
mod recovery;
mod servo;
mod strategy_contract;
mod surface;
mod third_opinion;
mod timestep;
mod toss;
mod walkers;
mod wheel_log;
