//! A robot in motion: as a page, as an animated picture, and in the formats of other programs.

mod animation;
mod foxglove;
mod gltf;
pub(in crate::report) mod look;
pub(in crate::report) mod motion;
pub(in crate::report) mod page;
pub(in crate::report) mod side_by_side;
pub(in crate::report) mod solid;
pub(in crate::report) mod stage;
pub(in crate::report) mod track;
