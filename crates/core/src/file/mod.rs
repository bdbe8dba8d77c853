//! Reading and writing of files: RON and JSON texts with located errors, CSV logs, MCAP, PNG, and checksums of results folders.
//!
//! [`Source`] is a text with its path; [`parse_ron`] turns it into a typed value or into an
//! [`Error`](crate::Error) that names file, line, column and field. Errors that types cannot exclude (two modules on one
//! face, a cycle) are found by later checks; [`Source::at`] adds the line to such an error.
//!
//! ```
//! use realgap_core::file::{Source, parse_ron};
//!
//! #[derive(Debug, serde::Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Floor {
//!     friction: f64,
//! }
//!
//! let source = Source::new("floor.ron", "(\n    fricton: 0.4,\n)");
//! let error = parse_ron::<Floor>(&source).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "floor.ron:2:5: fricton: unknown field\n  \
//!        found:   fricton\n  \
//!        allowed: friction\n  \
//!        hint:    did you mean `friction`?"
//! );
//!
//! let source = Source::new("floor.ron", "(friction: 0.4)");
//! assert_eq!(parse_ron::<Floor>(&source)?.friction, 0.4);
//! # Ok::<(), realgap_core::Error>(())
//! ```

mod bitmap;
mod byte_reader;
mod decode;
mod editor;
mod hash;
mod input;
mod json;
mod log;
mod mcap;
mod name;
mod orientation;
mod outline;
mod output;
mod seal;
mod source;
mod suggestion;
mod unique;
mod xml;
mod zip;
mod zstd;

pub use bitmap::{AnimatedPng, png_bytes};
pub use byte_reader::ByteReader;
pub use decode::{parse_ron, write_ron};
pub use editor::{Replaced, RonEditor};
pub use hash::sha256;
pub use input::{read_limited, read_regular};
pub use json::{SCHEMA_VERSION, versioned_json, versioned_value};
pub use log::{LogTable, read_log_text};
pub use mcap::{McapChannel, McapWriter, Stamp, Topic, read_mcap, read_thin_mcap, stamp};
pub use name::{check_name, name_of_file};
pub use orientation::orientation;
pub use output::{check_writable, write_atomic};
pub use seal::{SEAL_FILE, Seal, remove_sealed, write_sealed};
pub use source::{MAX_FILE_BYTES, MAX_NESTING, Source};
pub use suggestion::{look_up, nearest_name, unknown_name};
pub use unique::unique_keys;
pub use xml::{XmlLimits, XmlSize, measure_xml};
pub use zip::read_zip;
pub use zstd::read_zstd;
