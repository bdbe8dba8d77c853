//! Shared foundations of every realgap crate: errors, warnings, units, random number streams, statistics and file access.

pub mod confined;
mod declaration;
pub mod error;
pub mod file;
pub mod font;
pub mod quantity;
pub mod random;
pub mod range;
#[cfg(feature = "schema")]
pub mod schema;
pub mod statistics;
pub mod table;
pub mod text;
pub mod unit;
pub mod warning;

pub use error::{Advice, Error, ErrorKind, Result};
pub use warning::{Code, Warning};
