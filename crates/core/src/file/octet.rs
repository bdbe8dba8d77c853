//! Numbers and bytes out of a binary file, never beyond its end.

/// What is left of some bytes.
#[derive(Debug, Clone, Copy)]
pub struct Octets<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Octets<'a> {
    /// Reads from the first byte on.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// How many bytes have been taken.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Whether every byte was read.
    pub fn is_empty(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next `count` bytes; `None` where there are not as many.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    /// All that is left.
    pub fn rest(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        self.at = self.bytes.len();
        rest
    }

    /// The next `N` bytes, if there are so many.
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// The next byte.
    pub fn u8(&mut self) -> Option<u8> {
        Some(self.array::<1>()?[0])
    }

    /// The next two bytes, the lowest first.
    pub fn u16_le(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes(self.array()?))
    }

    /// The next four bytes, the lowest first.
    pub fn u32_le(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.array()?))
    }

    /// The next eight bytes, the lowest first.
    pub fn u64_le(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.array()?))
    }
}

#[cfg(test)]
mod tests {
    use super::Octets;

    #[test]
    fn nothing_is_taken_beyond_the_end() {
        let mut octets = Octets::new(&[1, 2, 0, 0, 0, 7]);
        assert_eq!(octets.u8(), Some(1));
        assert_eq!(octets.u32_le(), Some(2));
        assert_eq!(octets.u16_le(), None);
        assert_eq!(octets.take(usize::MAX), None);
        assert_eq!(
            (octets.at(), octets.rest(), octets.is_empty()),
            (5, &[7][..], true)
        );
    }
}
