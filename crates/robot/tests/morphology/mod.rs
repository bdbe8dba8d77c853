//! Tests of morphologies: shipped robots, refused files, random robots, and assembly.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod assembly;
mod property;
mod refusal;
mod shipped;
mod unreadable;
