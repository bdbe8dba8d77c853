//! The bits and codes of the pixels in a JPEG file.

/// The longest code, bits.
const LONGEST: usize = 16;

/// What is not there.
pub(super) enum Missing {
    /// The coded pixels end.
    Bits,
    /// The table has no such code.
    Code,
}

/// A table of Huffman codes.
pub(super) struct Codes {
    /// For each length, the first code behind those of this length, aligned to the left in 16 bits.
    ends: [u32; LONGEST],
    /// For each length, the index of its first symbol less its first code.
    shifts: [i64; LONGEST],
    symbols: Vec<u8>,
}

impl Codes {
    /// The symbol of the shortest code, which consists of zeros.
    pub(super) fn first(&self) -> Option<u8> {
        self.symbols.first().copied()
    }

    /// The table with so many codes of each length, for these symbols.
    pub(super) fn new(counts: &[u8; LONGEST], symbols: &[u8]) -> Self {
        let (mut ends, mut shifts) = ([0; LONGEST], [0; LONGEST]);
        let (mut code, mut index) = (0_u32, 0_i64);
        for (length, count) in counts.iter().enumerate() {
            shifts[length] = index - i64::from(code);
            code = code.saturating_add(u32::from(*count));
            index += i64::from(*count);
            ends[length] = code
                .checked_shl((LONGEST - 1 - length) as u32)
                .unwrap_or(u32::MAX);
            code = code.saturating_mul(2);
        }
        Self {
            ends,
            shifts,
            symbols: symbols.to_vec(),
        }
    }
}

/// The bits of coded pixels up to the next marker.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
    held: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            held: 0,
            count: 0,
        }
    }

    fn fill(&mut self) {
        while self.count <= 48 {
            let step = match (self.bytes.get(self.at), self.bytes.get(self.at + 1)) {
                // 0xff is written as 0xff 0x00; any other byte behind it makes a marker.
                (Some(0xff), Some(0)) => 2,
                (Some(0xff) | None, _) => return,
                _ => 1,
            };
            self.held = self.held << 8 | u64::from(self.bytes[self.at]);
            self.at += step;
            self.count += 8;
        }
    }

    /// The next bits as a number, at most 16 of them.
    pub(super) fn take(&mut self, size: u32) -> Result<u32, Missing> {
        if self.count < size {
            self.fill();
            if self.count < size {
                return Err(Missing::Bits);
            }
        }
        self.count -= size;
        Ok((self.held >> self.count) as u32 & ((1 << size) - 1))
    }

    /// The next number of so many bits; those that begin with 0 are negative.
    pub(super) fn number(&mut self, size: u32) -> Result<i64, Missing> {
        let bits = i64::from(self.take(size)?);
        let is_negative = size > 0 && bits < 1 << (size - 1);
        Ok(match is_negative {
            true => bits - (1 << size) + 1,
            false => bits,
        })
    }

    /// The symbol of the next code.
    pub(super) fn code(&mut self, codes: &Codes) -> Result<u8, Missing> {
        if self.count < LONGEST as u32 {
            self.fill();
        }
        let longest = LONGEST as u32;
        let next = match self.count >= longest {
            true => (self.held >> (self.count - longest)) as u32 & 0xffff,
            // The end is filled with ones, as encoders fill it: no code consists of ones only.
            false => {
                let lack = longest - self.count;
                let own = self.held as u32 & ((1 << self.count) - 1);
                own << lack | ((1 << lack) - 1)
            }
        };
        let mut ends = codes.ends.iter();
        let at_end = self.count < longest;
        let Some(length) = ends.position(|end| next < *end) else {
            return Err(if at_end { Missing::Bits } else { Missing::Code });
        };
        let code = next >> (LONGEST - 1 - length);
        self.take(length as u32 + 1)?;
        let index = i64::from(code) + codes.shifts[length];
        let symbol = usize::try_from(index)
            .ok()
            .and_then(|i| codes.symbols.get(i));
        symbol.copied().ok_or(Missing::Code)
    }

    /// Whole bytes up to the next marker. They are passed, and so is what fills the last byte: ones, or zeros; `None` for other bits.
    pub(super) fn bytes_left(&mut self) -> Option<usize> {
        let fill = self.count % 8;
        let whole = self.count - fill;
        let filled = (self.held >> whole) as u32 & ((1 << fill) - 1);
        let is_fill = filled == 0 || filled == (1 << fill) - 1;
        let mut left = 0;
        loop {
            left += self.count as usize / 8;
            (self.count, self.held) = (0, 0);
            self.fill();
            if self.count == 0 {
                return (is_fill || left > 0).then_some(left);
            }
        }
    }

    /// Passes the restart marker with this number; false if something else is there.
    pub(super) fn restarts(&mut self, number: u8) -> bool {
        // 0xff may be repeated before a marker.
        while self.bytes.get(self.at..self.at + 2) == Some(&[0xff, 0xff]) {
            self.at += 1;
        }
        let is_there = self.bytes.get(self.at..self.at + 2) == Some(&[0xff, 0xd0 + number]);
        if is_there {
            self.at += 2;
        }
        is_there
    }

    /// How many bytes were passed, at a marker.
    pub(super) fn place(&self) -> usize {
        self.at
    }
}
