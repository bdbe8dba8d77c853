//! Tests of arenas, range sensors, Bayes filters, sensorgraphs, radio models and task times.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

mod arena;
mod belief;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod radio;
mod room;
mod sensing;
mod sensorgraph;
mod task;
