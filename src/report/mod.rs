//! Pages: one HTML file that explains itself, opens from disk and asks no network.
//!
//! A [`Replay`] shows a robot in motion, its recorded runs over it; [`folder_page`] what a results folder holds. Everything in a page is readable without scripts as far as
//! text, tables and charts go; only the page's own scripts may run, named by their hashes in its content policy; texts of
//! others are escaped. Same data, same bytes.

mod base64;
mod block;
mod chart;
mod folder;
mod heat;
mod page;
mod replay;
mod track;

pub use folder::folder_page;
pub use replay::{Replay, SIMULATION};
