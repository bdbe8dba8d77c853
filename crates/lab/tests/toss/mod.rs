//! Tests with tossed cubes: identification before contact, start states, evaluation, length scale, round edges.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod flight;
mod real;
mod scale;
mod shape;
mod standin;
