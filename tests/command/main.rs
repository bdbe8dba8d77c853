//! What every command says and writes.

mod cli;
#[path = "../common/mod.rs"]
mod common;
mod equal_runs;
mod foreign;
mod hint;
mod new;
mod verify;
