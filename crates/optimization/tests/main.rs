//! Tests of all optimizers.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod contract;
