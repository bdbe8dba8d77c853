//! Recordings that people really have, and files of others' formats.

#[path = "../common/mod.rs"]
mod common;
mod open_format;
mod reading;
