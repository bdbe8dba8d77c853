//! Verifies the rollback journal that a killed recorder leaves beside its bag.
//!
//! The journal holds the old content of pages that an unfinished change has overwritten. SQLite puts back what it finds there, and ignores
//! without an error what was cut off: the rest of the pages stays in its unfinished state, and rows are lost or made up.
//!
//! Format: <https://www.sqlite.org/fileformat2.html#the_rollback_journal>.

use std::path::Path;

use super::connection::with_suffix;
use super::log::word;
use realgap_core::error::{Error, Result};

/// The first bytes of a journal that is in use.
const MAGIC: [u8; 8] = [0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7];
const HEADER: usize = 28;
/// The number of pages of a journal that its writer did not wait for: as many as are there.
const AS_MANY_AS_THERE: u32 = u32::MAX;

/// What a journal is worth.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Journal {
    /// There is none, or one that was closed.
    None,
    /// It holds the old content of all pages that a change has overwritten.
    Whole,
    /// It does not; what was found.
    Damaged(String),
}

/// The state of a database's journal.
///
/// # Errors
/// A journal that cannot be read.
pub(super) fn journal_of(database: &Path) -> Result<Journal> {
    let path = with_suffix(database, "-journal");
    match std::fs::read(&path) {
        Ok(journal) => Ok(state(&journal)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Journal::None),
        Err(e) => Err(Error::io("read the journal", &path, &e)),
    }
}

fn state(journal: &[u8]) -> Journal {
    let Some(first) = journal.first() else {
        return Journal::None;
    };
    // A closed journal that is kept begins with zeros.
    if *first == 0 {
        return Journal::None;
    }
    let cut = |pages: usize, stated: usize| {
        Journal::Damaged(format!(
            "a journal that is cut off after {pages} of {stated} pages"
        ))
    };
    if journal.len() < HEADER {
        return cut(0, 1);
    }
    let mut at = 0;
    while let Some(header) = journal.get(at..at + HEADER) {
        if header[..8] != MAGIC {
            // Behind the last part stands the name of a journal of several databases, or what another change has left.
            return match at {
                0 => Journal::Damaged("a header that has changed".to_owned()),
                _ => Journal::Whole,
            };
        }
        let (stated, nonce) = (word(header, 8), word(header, 12));
        let (sector, page) = (word(header, 20) as usize, word(header, 24) as usize);
        let is_size = |size: usize| size.is_power_of_two() && size <= 65_536;
        if !is_size(sector) || !is_size(page) || sector < HEADER || page < 512 {
            return Journal::Damaged("a header that has changed".to_owned());
        }
        let record = 4 + page + 4;
        let records = journal.get(at + sector..).unwrap_or_default();
        let whole = records.len() / record;
        let count = match stated {
            AS_MANY_AS_THERE if records.len() % record != 0 => return cut(whole, whole + 1),
            AS_MANY_AS_THERE => whole,
            stated => stated as usize,
        };
        if whole < count {
            return cut(whole, count);
        }
        for (number, record) in records.chunks_exact(record).take(count).enumerate() {
            if word(record, 4 + page) != checksum(nonce, &record[4..4 + page]) {
                return Journal::Damaged(format!("page {} has changed", number + 1));
            }
        }
        at = (at + sector + count * record).next_multiple_of(sector);
    }
    Journal::Whole
}

/// The checksum of a page: every 200th byte from the end.
fn checksum(nonce: u32, page: &[u8]) -> u32 {
    let places = (1..).map_while(|step| page.len().checked_sub(200 * step));
    places
        .take_while(|place| *place > 0)
        .fold(nonce, |sum, place| sum.wrapping_add(u32::from(page[place])))
}
