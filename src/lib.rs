//! TODO primer

pub mod comparison;
pub mod error;
pub mod export;
pub mod file;
pub mod folder;
pub mod morphology;
pub mod parameter;
pub mod quantity;
pub mod report;
pub mod simulation;
pub mod store;
pub mod study;
pub mod trajectory;
pub mod tuning;
pub mod warning;

pub use error::{Error, ErrorKind, Result};
pub use warning::Warning;
