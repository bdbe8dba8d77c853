//! Stores results on disk: one SQLite file per results folder, which survives kill −9 at any moment.
//!
//! Every finished row is one transaction, so a row is stored either completely or not at all. Each kind of run has its type of
//! row: a [`Trial`] of a study, a [`RobotRow`] of a search. Each row has a checksum, and the store records the number of rows: results
//! that were changed after they were written are an error, never a different answer.
//! The folder is locked while a process writes into it, and a [`Fingerprint`] of everything that
//! decides the results prevents a mixture of two studies in one folder.
//!
//! This crate also reads databases and tables of other programs: bags of ROS 2 (which are SQLite files) and Parquet files.
//!
//! ```
//! use realgap_store::{Fingerprint, RobotOutcome, RobotRow, Store};
//!
//! let folder = std::env::temp_dir().join(format!("realgap-store-{}", std::process::id()));
//! let row = RobotRow {
//!     index: 0,
//!     genome: vec![0.5; 10],
//!     outcome: RobotOutcome::Failed { reason: "flying".to_owned(), seen: "2 m up".to_owned() },
//! };
//! let mut store = Store::create(&folder, &Fingerprint::new().with("search", "mine"))?;
//! store.insert(std::slice::from_ref(&row))?;
//! assert_eq!(Store::<RobotRow>::read(&folder)?.rows()?, [row]);
//! # drop(store);
//! # std::fs::remove_dir_all(&folder).expect("it was just made");
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod bag;
mod checksum;
mod connection;
mod content;
mod count;
mod database;
mod description;
mod file_system;
mod fingerprint;
mod journal;
mod listing;
mod lock;
mod log;
mod merge;
mod opening;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "parquet")]
mod parquet_pages;
#[cfg(feature = "parquet")]
mod parquet_table;
mod part;
mod robot;
mod row;
mod run;
mod score;
mod share;
mod storage;
#[cfg(test)]
mod tests;
mod thin_bag;
mod trial;

pub use bag::{read_bag, read_closed_bag};
pub use database::{STORE_FILE, Store};
pub use fingerprint::Fingerprint;
pub use listing::{Cell, Column, ColumnKind, Listing};
pub use lock::{FolderLock, Place};
pub use merge::{Absorbed, Merger};
pub use opening::Mode;
#[cfg(feature = "parquet")]
pub use parquet::to_parquet;
#[cfg(feature = "parquet")]
pub use parquet_table::parquet_table;
pub use part::Part;
pub use robot::{RobotOutcome, RobotRow, TravelRow};
pub use row::Row;
pub use row::Table;
pub use run::RunRow;
pub use share::{MAX_SHARES, Share};
pub use storage::{Memory, Storage};
pub use thin_bag::read_thin_bag;
pub use trial::{CaseOutcome, CaseResult, CaseRow, Trial, TrialScore};
