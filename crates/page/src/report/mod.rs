//! Pages: one HTML file that explains itself, opens from disk and asks no network.
//!
//! A [`Replay`] shows a robot in motion, its recorded runs over it; [`folder_page`] what a results folder holds, with what its
//! command has [`Kept`] for it. Everything in a page is readable without scripts as far as text, tables and charts go; only
//! the page's own scripts may run, named by their hashes in its content policy; texts of others are escaped. Same data, same
//! bytes.

#[cfg(test)]
mod contradiction;
mod document;
mod folder;
mod replay;
mod single_report;

pub use folder::folder_page;
pub use folder::page_data::{KEPT_RECORDINGS, Kept, KeptPath, KeptReplay, PAGE_FILE};
pub use folder::tree::Tree;
pub use replay::look::{ShownSolid, shown_body, shown_parts};
pub use replay::motion::ShownScene;
pub use replay::page::{Replay, SIMULATION};
pub use replay::side_by_side::side_by_side;
pub use single_report::Leaf;
