//! Reads and writes MCAP containers (<https://mcap.dev/spec>): messages of many channels in one file, as ROS 2 and Foxglove record them.
//!
//! This project has a small reader and writer of its own, because the crate `mcap` depends on fifteen more crates, and on C code for
//! its compression (docs/design.md).

mod foxglove;
mod read;
mod thin;
mod write;

pub use foxglove::{Stamp, Topic, stamp};
pub use read::{Channel as McapChannel, read_mcap};
pub use thin::read_thin_mcap;
pub use write::McapWriter;

/// The signature: the first and the last bytes of a file.
const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Kinds of records, by their first byte.
mod opcode {
    pub const HEADER: u8 = 1;
    pub(crate) const FOOTER: u8 = 2;
    pub(crate) const SCHEMA: u8 = 3;
    pub(crate) const CHANNEL: u8 = 4;
    pub(crate) const MESSAGE: u8 = 5;
    pub(crate) const CHUNK: u8 = 6;
    pub(crate) const MESSAGE_INDEX: u8 = 7;
    pub(crate) const CHUNK_INDEX: u8 = 8;
    pub(crate) const STATISTICS: u8 = 11;
    pub(crate) const SUMMARY_OFFSET: u8 = 14;
    pub(crate) const DATA_END: u8 = 15;
}
