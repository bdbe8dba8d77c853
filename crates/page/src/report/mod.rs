//! Pages: HTML files that need nothing beside them, open from disk and use no network.
//!
//! A [`Replay`] shows a robot in motion, with its recorded runs over it; a [`ResultsPage`] what a results folder holds, with the
//! [`PageData`] that its command keeps beside; a [`SingleReport`] what a command without a folder found; a [`LivePage`] what a run
//! knows that goes on. Text, tables and charts
//! of a page can be read without scripts. Only the page's own scripts may run: its content policy names them by their hashes.
//! Texts of others are escaped. The same data give the same bytes.

#[cfg(test)]
mod contradiction;
mod document;
mod folder;
mod live;
mod replay;
mod single_report;

pub(crate) use document::picture::Pictures;
pub(crate) use document::value::odds;
pub use folder::page_data::{
    NextCommand, PAGE_FILE, PageData, RecordedPath, ReplayData, SHOWN_RECORDINGS,
};
pub use folder::tree::ReportTree;
pub use folder::{ResultsPage, compared_page, folder_page};
pub use live::LivePage;
pub use replay::look::{ShownSolid, shown_body, shown_parts};
pub use replay::motion::ShownScene;
pub use replay::page::{Replay, SIMULATION};
pub use replay::side_by_side::side_by_side;
pub use single_report::SingleReport;
