//! Documentation, licences and schemas agree with the program.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "../common/mod.rs"]
mod common;
mod documentation;
mod licence;
mod readme;
mod rule;
mod schema;
mod tutorial;
