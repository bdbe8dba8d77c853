//! Stories about robots: the shipped ones, the refused ones, and random ones.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod assembly;
mod property;
mod refusal;
mod shipped;
mod unreadable;
