//! Computes checksums of rows, because SQLite does not notice when the bytes of a stored value change.

use sha2::{Digest, Sha256};

/// A checksum that is built field by field: the first 64 bits of SHA-256 over the fields of a row, each preceded by its length.
pub(super) struct Checksum(Sha256);

impl Checksum {
    /// Starts the checksum of a row of this table.
    pub fn of(table: &str) -> Self {
        Self(Sha256::new()).text(table)
    }

    #[must_use]
    pub fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }

    #[must_use]
    pub fn whole(self, number: i64) -> Self {
        self.bytes(&number.to_le_bytes())
    }

    #[must_use]
    pub fn number(self, number: Option<f64>) -> Self {
        match number {
            Some(number) => self.bytes(&number.to_le_bytes()),
            None => self.bytes(&[]),
        }
    }

    #[must_use]
    pub fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
        self
    }

    pub fn finish(self) -> i64 {
        let digest = self.0.finalize();
        let mut first = [0; 8];
        first.copy_from_slice(&digest[..8]);
        i64::from_le_bytes(first)
    }
}

/// The number of rows of a store and the exclusive or of their checksums, so that a missing or a duplicate row is noticed too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Tally {
    pub rows: i64,
    pub checksum: i64,
}

impl Tally {
    pub fn add(&mut self, checksum: i64) {
        self.rows += 1;
        self.checksum ^= checksum;
    }

    pub fn remove(&mut self, checksum: i64) {
        self.rows -= 1;
        self.checksum ^= checksum;
    }
}

/// Converts numbers to little-endian bytes, which keep every bit of every number.
pub(super) fn to_bytes(values: &[f64]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

pub(super) fn from_bytes(bytes: &[u8]) -> Vec<f64> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|chunk| f64::from_le_bytes(*chunk))
        .collect()
}
