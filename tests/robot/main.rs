//! Robots in the commands: made, developed, exported, imported, searched.

#[path = "../common/mod.rs"]
mod common;
mod develop;
mod export;
mod finalists;
mod import;
mod robot_search;
