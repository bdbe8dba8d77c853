//! Robots, shaded: still in a gallery, or in motion.

pub(super) mod animation;
pub(super) mod block;
pub(super) mod gallery;
mod surface;
