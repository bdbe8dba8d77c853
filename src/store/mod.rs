//! Results on disk: one SQLite file per results folder, safe against kill −9 at any moment.
//!
//! Every finished trial is one transaction, so a trial is either completely there or not at all.
//! The folder is locked while a process writes into it, and a [`Fingerprint`] of everything that
//! decides the results refuses to mix two studies in one folder.

mod database;
mod fingerprint;
mod listing;
mod lock;
mod opening;
mod parquet;
mod storage;
#[cfg(test)]
mod tests;
mod trial;

pub use database::{STORE_FILE, Store};
pub use fingerprint::Fingerprint;
pub use listing::{Cell, ListedTrial, Listing};
pub use opening::Mode;
pub use parquet::to_parquet;
pub use storage::{Memory, Row, Storage};
pub use trial::{Outcome, OutcomeStatus, Trial, TrialScore};
