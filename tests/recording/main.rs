//! Recordings as users have them, and files of other programs' formats.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod open_format;
mod reading;
