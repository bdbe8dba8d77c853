//! What everything rests on.

#[path = "../../../tests/common/shared.rs"]
mod common;
mod statistic;
