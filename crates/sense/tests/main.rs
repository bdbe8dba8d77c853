//! Sensing: arenas, ranges, beliefs, sensorgraphs, radio, times of tasks.

mod arena;
mod belief;
#[path = "../../../tests/common/shared.rs"]
mod common;
mod radio;
mod room;
mod sensing;
mod sensorgraph;
mod task;
