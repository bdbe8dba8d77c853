//! Tests of the closed-form checks.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod verification;
