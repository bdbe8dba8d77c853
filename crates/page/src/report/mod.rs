//! Pages: one HTML file that explains itself, opens from disk and asks no network.
//!
//! A [`Replay`] shows a robot in motion, its recorded runs over it; [`folder_page`] what a results folder holds, with what its
//! command has [`Kept`] for it. Everything in a page is readable without scripts as far as text, tables and charts go; only
//! the page's own scripts may run, named by their hashes in its content policy; texts of others are escaped. Same data, same
//! bytes.

mod animation;
mod base64;
mod block;
mod chart;
mod claim;
#[cfg(test)]
mod contradiction;
mod ensemble;
mod fleet;
mod folder;
mod foxglove;
mod gap;
mod gltf;
mod heat;
mod joint;
mod kept;
mod leaf;
mod look;
mod motion;
mod page;
mod parade;
mod path;
mod points;
mod prediction;
mod replay;
mod search;
mod section;
mod sheet;
mod solid;
mod stage;
mod story;
mod study;
mod track;
mod tree;
mod tuning;
mod value;

pub use folder::folder_page;
pub use kept::{KEPT_RECORDINGS, Kept, KeptPath, KeptReplay, PAGE_FILE};
pub use leaf::Leaf;
pub use look::{ShownSolid, shown_body, shown_parts};
pub use motion::ShownScene;
pub use parade::side_by_side;
pub use replay::{Replay, SIMULATION};
pub use tree::Tree;
