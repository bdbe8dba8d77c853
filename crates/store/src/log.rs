//! Verifies the write-ahead log that a killed run leaves beside its store.
//!
//! SQLite reads such a log up to the first frame with a wrong checksum, and ignores the rest without an error. This is right after a
//! write that was cut off, but wrong after damage, because the frames that follow were written and would be lost. This module reads the
//! whole log: frames of the same run behind a frame with a wrong checksum mean that the log is damaged.
//!
//! Format: <https://www.sqlite.org/fileformat2.html#walformat>.

use std::path::Path;

use super::connection::with_suffix;
use realgap_core::error::{Advice, Error, Result};

const HEADER: usize = 32;
const FRAME_HEADER: usize = 24;
/// Magic number of a log whose checksums use little-endian words; the number is larger by one for big-endian words.
const MAGIC: u32 = 0x377f_0682;

/// Checks the log of a store that no process writes into.
///
/// # Errors
/// A log with a damaged header, or with frames that were written behind a damaged one.
pub(super) fn verify_log(store: &Path) -> Result<()> {
    match damage_of(store)? {
        None => Ok(()),
        Some(found) => Err(Error::conflict("the results are damaged")
            .at_file(with_suffix(store, "-wal"))
            .found(found)
            .allowed("exactly the bytes that were written")
            .hint("the last points of an interrupted run are in this file: restore it from a backup, or let them be computed again")
            .advise(Advice::Resume)),
    }
}

/// Describes the damage of a database's log; `None` if it is intact or missing.
///
/// # Errors
/// A log that cannot be read.
pub(super) fn damage_of(database: &Path) -> Result<Option<String>> {
    let path = with_suffix(database, "-wal");
    match std::fs::read(&path) {
        Ok(log) => Ok(damage(&log)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(Error::io("read the log", &path, &e)),
    }
}

/// What a killed writer has left behind the last change that it finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rest {
    Nothing,
    /// Whole pages of a change that was not finished.
    Unfinished,
    /// A part of a page: the file was cut off.
    Cut,
}

/// What is behind the last finished change in the log of a database.
///
/// # Errors
/// A log that cannot be read.
pub(super) fn rest_of(database: &Path) -> Result<Rest> {
    let path = with_suffix(database, "-wal");
    match std::fs::read(&path) {
        Ok(log) => Ok(rest(&log)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Rest::Nothing),
        Err(e) => Err(Error::io("read the log", &path, &e)),
    }
}

fn rest(log: &[u8]) -> Rest {
    if log.len() < HEADER {
        return match log.is_empty() {
            true => Rest::Nothing,
            false => Rest::Cut,
        };
    }
    let frames = log[HEADER..].chunks_exact(FRAME_HEADER + (word(log, 8) as usize).max(512));
    if !frames.remainder().is_empty() {
        return Rest::Cut;
    }
    let own = frames.take_while(|frame| frame[8..16] == log[16..24]);
    // The last page of a change states the size of the database.
    match own.last() {
        Some(last) if word(last, 4) == 0 => Rest::Unfinished,
        _ => Rest::Nothing,
    }
}

/// Describes the damage of a log; `None` if it is intact.
fn damage(log: &[u8]) -> Option<String> {
    if log.len() < HEADER {
        // The log was created but its header was not written yet, so it holds no frames.
        return None;
    }
    let (magic, page) = (word(log, 0), word(log, 8) as usize);
    let mut sums = Sums {
        big_endian: magic & 1 == 1,
        values: [0; 2],
    };
    sums.add(&log[..24]);
    if magic & !1 != MAGIC || sums.values != [word(log, 24), word(log, 28)] {
        return Some("a header that has changed".to_owned());
    }
    let salt = &log[16..24];
    let mut broken = None;
    let mut frames = log[HEADER..].chunks_exact(FRAME_HEADER + page.max(512));
    for (number, frame) in frames.by_ref().enumerate() {
        let is_of_this_run = &frame[8..16] == salt;
        if let Some(first) = broken {
            if is_of_this_run {
                return Some(format!("page {} has changed", first + 1));
            }
            continue;
        }
        sums.add(&frame[..8]);
        sums.add(&frame[FRAME_HEADER..]);
        if !is_of_this_run || sums.values != [word(frame, 16), word(frame, 20)] {
            broken = Some(number);
        }
    }
    None
}

pub(super) fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// The running checksum of a log, as SQLite computes it.
struct Sums {
    big_endian: bool,
    values: [u32; 2],
}

impl Sums {
    /// Adds `bytes`, which hold pairs of 32-bit words.
    fn add(&mut self, bytes: &[u8]) {
        let [mut first, mut second] = self.values;
        for pair in bytes.chunks_exact(8) {
            let word = |at: usize| {
                let word = word(pair, at);
                if self.big_endian {
                    word
                } else {
                    word.swap_bytes()
                }
            };
            first = first.wrapping_add(word(0)).wrapping_add(second);
            second = second.wrapping_add(word(4)).wrapping_add(first);
        }
        self.values = [first, second];
    }
}
