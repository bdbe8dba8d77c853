//! Integration tests of the crate `realgap-path`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../../../tests/common/shared.rs"]
mod common;
mod doubts;
mod foreign_table;
mod formats;
mod golden;
mod inferred_reading;
mod joint_log;
mod metric_contract;
mod preparation;
mod principal_components;
mod time;
mod whitened;
