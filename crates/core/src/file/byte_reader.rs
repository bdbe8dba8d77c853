//! Reads numbers and bytes from binary data, and never beyond its end.

/// A reader over a slice of bytes, with its position.
#[derive(Debug, Clone, Copy)]
pub struct ByteReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> ByteReader<'a> {
    /// A reader at the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The position: the number of bytes that were taken.
    pub fn at(&self) -> usize {
        self.at
    }

    /// True if every byte was taken.
    pub fn is_empty(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next `count` bytes; `None` if fewer bytes are left.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    /// All bytes that are left.
    pub fn rest(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        self.at = self.bytes.len();
        rest
    }

    /// The next `N` bytes; `None` if fewer bytes are left.
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// The next byte as a number.
    pub fn u8(&mut self) -> Option<u8> {
        Some(self.array::<1>()?[0])
    }

    /// The next two bytes as a little-endian number.
    pub(crate) fn u16_le(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes(self.array()?))
    }

    /// The next four bytes as a little-endian number.
    pub(crate) fn u32_le(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.array()?))
    }

    /// The next eight bytes as a little-endian number.
    pub(crate) fn u64_le(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.array()?))
    }
}

#[cfg(test)]
mod tests {
    use super::ByteReader;

    #[test]
    fn no_bytes_are_taken_beyond_the_end() {
        let mut reader = ByteReader::new(&[1, 2, 0, 0, 0, 7]);
        assert_eq!(reader.u8(), Some(1));
        assert_eq!(reader.u32_le(), Some(2));
        assert_eq!(reader.u16_le(), None);
        assert_eq!(reader.take(usize::MAX), None);
        assert_eq!(
            (reader.at(), reader.rest(), reader.is_empty()),
            (5, &[7][..], true)
        );
    }
}
