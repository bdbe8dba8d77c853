//! Pages, replays and pictures.

#[path = "../common/mod.rs"]
mod common;
mod gallery;
mod pages;
mod replay;
mod replay_file;
mod report;
