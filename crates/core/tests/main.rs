//! Integration tests of the crate `realgap-core`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../../../tests/common/shared.rs"]
mod common;
mod statistic;
