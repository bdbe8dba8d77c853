//! Decodes the two encodings of ROS messages: CDR (of the Object Management Group) of ROS 2, in which numbers are aligned to their size, and
//! that of ROS 1, which has no gaps.

use realgap_core::file::ByteReader;

/// A decoder of one message.
pub(super) struct Cdr<'a> {
    input: ByteReader<'a>,
    is_big_endian: bool,
    /// The largest alignment, bytes; larger numbers are aligned to it.
    max_alignment: usize,
    /// The number of bytes before the message; alignment is counted from behind them.
    head: usize,
}

/// The number of bytes before the message, which state the encoding; alignment is counted from behind them.
const HEAD: usize = 4;

impl<'a> Cdr<'a> {
    /// A decoder at the start of a message; `None` for an encoding that is not used for these messages.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let mut input = ByteReader::new(bytes);
        let [0, kind, ..] = input.array::<HEAD>()? else {
            return None;
        };
        let max_alignment = match kind {
            0 | 1 => 8,
            // The second version of CDR.
            6 | 7 => 4,
            _ => return None,
        };
        Some(Self {
            input,
            is_big_endian: kind % 2 == 0,
            max_alignment,
            head: HEAD,
        })
    }

    /// A decoder of a message of ROS 1: little-endian, without gaps.
    pub(super) fn ros1(bytes: &'a [u8]) -> Self {
        Self {
            input: ByteReader::new(bytes),
            is_big_endian: false,
            max_alignment: 1,
            head: 0,
        }
    }

    /// True for a message of ROS 1, whose headers also count messages.
    pub(super) fn is_ros1(&self) -> bool {
        self.head == 0
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        let size = N.min(self.max_alignment);
        let beyond = (self.input.at() - self.head) % size;
        if beyond > 0 {
            self.input.take(size - beyond)?;
        }
        let mut bytes: [u8; N] = self.input.array()?;
        if self.is_big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.number()?))
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        Some(i32::from_le_bytes(self.number()?))
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.number()?))
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut all = [0.0; N];
        for value in &mut all {
            *value = self.f64()?;
        }
        Some(all)
    }

    /// A list of numbers of any length.
    pub(super) fn list(&mut self) -> Option<Vec<f64>> {
        (0..self.u32()?).map(|_| self.f64()).collect()
    }

    /// A list of texts.
    pub(super) fn texts(&mut self) -> Option<Vec<String>> {
        (0..self.u32()?).map(|_| self.text()).collect()
    }

    pub(super) fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.u32()?).ok()?;
        let bytes = self.input.take(length)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Some(String::from_utf8_lossy(bytes).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::Cdr;

    #[test]
    fn numbers_are_aligned_to_their_size_in_both_byte_orders() {
        // A text of one letter, then a number of eight bytes.
        let little = [
            &[0, 1, 0, 0, 2, 0, 0, 0, b'a', 0, 9, 9][..],
            &2.5_f64.to_le_bytes(),
        ];
        let big = [
            &[0, 0, 0, 0, 0, 0, 0, 2, b'a', 0, 9, 9][..],
            &2.5_f64.to_be_bytes(),
        ];
        // The second version aligns to at most four bytes.
        let second = [
            &[0, 7, 0, 0, 2, 0, 0, 0, b'a', 0, 9, 9][..],
            &2.5_f64.to_le_bytes(),
        ];
        for parts in [little, big, second] {
            let is_second = parts[0][1] == 7;
            let mut bytes = parts.concat();
            if !is_second {
                // From offset 6, the next multiple of 8 is 8.
                assert_eq!(bytes.len(), 4 + 8 + 8);
            }
            let mut cdr = Cdr::new(&bytes).unwrap();
            assert_eq!(cdr.text().as_deref(), Some("a"));
            assert_eq!(cdr.f64(), Some(2.5));
            assert_eq!(cdr.u32(), None);
            bytes.truncate(bytes.len() - 1);
            let mut cdr = Cdr::new(&bytes).unwrap();
            assert_eq!(cdr.text().and_then(|_| cdr.f64()), None);
        }
    }

    #[test]
    fn a_text_that_is_longer_than_the_message_is_refused() {
        let mut cdr = Cdr::new(&[0, 1, 0, 0, 255, 255, 255, 255, b'a']).unwrap();
        assert_eq!(cdr.text(), None);
        assert!(Cdr::new(&[0, 3, 0, 0]).is_none());
        assert!(Cdr::new(&[0, 1, 0]).is_none());
    }
}
