//! What is written about the program is true.

#[path = "../common/mod.rs"]
mod common;
mod documentation;
mod house;
mod licence;
mod schema;
mod tutorial;
