//! Integration tests of the crate `realgap-store`.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod damage;
mod finished;
