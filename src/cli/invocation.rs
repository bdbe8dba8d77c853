//! The command line as the user typed it. Pages and scripts show it, so that a reader can run the command again.

use std::ffi::OsString;
use std::sync::OnceLock;

/// The arguments as the user typed them, before clap parses them.
static TYPED: OnceLock<Vec<OsString>> = OnceLock::new();

/// Records the arguments, the program's name first, and returns them unchanged.
pub fn record(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    TYPED.get_or_init(|| arguments.collect()).clone()
}

/// The recorded arguments, the program's name first; empty before [`record`] was called.
pub fn typed() -> &'static [OsString] {
    TYPED.get().map_or(&[], Vec::as_slice)
}
