//! The coding of ROS 2 messages (CDR of the Object Management Group): numbers at multiples of their size.

use realgap_core::file::ByteReader;

/// One coded message.
pub(super) struct Cdr<'a> {
    octets: ByteReader<'a>,
    is_big_endian: bool,
    /// Numbers larger than this are aligned as those of this size.
    most_aligned: usize,
}

/// Bytes before the message that say how it is coded; places are counted from behind them.
const HEAD: usize = 4;

impl<'a> Cdr<'a> {
    /// `None` for a coding of which messages of poses are never.
    pub(super) fn new(bytes: &'a [u8]) -> Option<Self> {
        let mut octets = ByteReader::new(bytes);
        let [0, kind, ..] = octets.array::<HEAD>()? else {
            return None;
        };
        let most_aligned = match kind {
            0 | 1 => 8,
            // The second version of CDR.
            6 | 7 => 4,
            _ => return None,
        };
        Some(Self {
            octets,
            is_big_endian: kind % 2 == 0,
            most_aligned,
        })
    }

    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        let size = N.min(self.most_aligned);
        let beyond = (self.octets.at() - HEAD) % size;
        if beyond > 0 {
            self.octets.take(size - beyond)?;
        }
        let mut bytes: [u8; N] = self.octets.array()?;
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

    pub(super) fn text(&mut self) -> Option<String> {
        let length = usize::try_from(self.u32()?).ok()?;
        let bytes = self.octets.take(length)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Some(String::from_utf8_lossy(bytes).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::Cdr;

    #[test]
    fn numbers_stand_at_multiples_of_their_size_in_either_order() {
        // A text of one letter, then a number of eight bytes.
        let little = [
            &[0, 1, 0, 0, 2, 0, 0, 0, b'a', 0, 9, 9][..],
            &2.5_f64.to_le_bytes(),
        ];
        let big = [
            &[0, 0, 0, 0, 0, 0, 0, 2, b'a', 0, 9, 9][..],
            &2.5_f64.to_be_bytes(),
        ];
        // The second version aligns to four at most.
        let second = [
            &[0, 7, 0, 0, 2, 0, 0, 0, b'a', 0, 9, 9][..],
            &2.5_f64.to_le_bytes(),
        ];
        for parts in [little, big, second] {
            let is_second = parts[0][1] == 7;
            let mut bytes = parts.concat();
            if !is_second {
                // From place 6 the next multiple of 8 is 8.
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
    fn a_text_that_claims_to_be_endless_is_refused() {
        let mut cdr = Cdr::new(&[0, 1, 0, 0, 255, 255, 255, 255, b'a']).unwrap();
        assert_eq!(cdr.text(), None);
        assert!(Cdr::new(&[0, 3, 0, 0]).is_none());
        assert!(Cdr::new(&[0, 1, 0]).is_none());
    }
}
