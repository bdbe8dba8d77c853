//! Columns of numbers as a compact text: rounded, as differences to the previous number, with seven bits a byte, in base64.
//!
//! A column is its length, then its numbers divided by the step and rounded. Each number is stored as its difference to the
//! previous one (the first: to 0). Differences are zigzag coded, so that small differences of either sign are small numbers. A
//! number has seven bits a byte, the lowest first; the eighth bit says that more bytes follow. `src/report/document/asset/block.js` reads it.

use crate::report::document::base64;

/// Columns of numbers for the scripts of a page.
#[derive(Debug, Clone, Default)]
pub(in crate::report) struct PackedColumns {
    bytes: Vec<u8>,
}

impl PackedColumns {
    /// Adds a column, its numbers rounded to multiples of `step`. A number that is not finite, or beyond 2⁵² steps, becomes 0.
    pub fn push(&mut self, values: impl ExactSizeIterator<Item = f64>, step: f64) {
        self.push_integer(values.len() as u64);
        let mut before = 0_i64;
        for value in values {
            let steps = (value / step).round();
            let number = if steps.abs() < (1_u64 << 52) as f64 {
                steps as i64
            } else {
                0
            };
            let difference = number - before;
            before = number;
            self.push_integer(((difference << 1) ^ (difference >> 63)) as u64);
        }
    }

    fn push_integer(&mut self, mut number: u64) {
        while number > 127 {
            self.bytes.push(number as u8 & 127 | 128);
            number >>= 7;
        }
        self.bytes.push(number as u8);
    }

    /// The text.
    pub fn text(&self) -> String {
        base64::encode(&self.bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `block.js` does, in Rust.
    fn read(bytes: &[u8], step: f64) -> Vec<f64> {
        let mut numbers = Vec::new();
        let mut at = 0;
        let mut next = || {
            let (mut number, mut shift) = (0_u64, 0);
            loop {
                let byte = bytes[at];
                at += 1;
                number |= u64::from(byte & 127) << shift;
                shift += 7;
                if byte < 128 {
                    return number;
                }
            }
        };
        let count = next();
        let mut sum = 0_i64;
        for _ in 0..count {
            let coded = next();
            sum += (coded >> 1) as i64 ^ -((coded & 1) as i64);
            numbers.push(sum as f64 * step);
        }
        numbers
    }

    #[test]
    fn what_is_written_is_read_back_to_half_a_step() {
        let values: Vec<f64> = (0..500)
            .map(|k| (f64::from(k) * 0.37).sin() * 3.0 - 1.0)
            .collect();
        let mut packed = PackedColumns::default();
        packed.push(values.iter().copied(), 1e-4);
        let back = read(&packed.bytes, 1e-4);
        assert_eq!(back.len(), values.len());
        for (a, b) in back.iter().zip(&values) {
            assert!((a - b).abs() <= 0.5e-4 + 1e-12, "{a} {b}");
        }
        assert!(packed.bytes.len() < 3 * values.len());
    }

    #[test]
    fn numbers_that_cannot_be_shown_do_no_harm() {
        let mut packed = PackedColumns::default();
        packed.push([f64::NAN, 1e300, -2.0].into_iter(), 1.0);
        assert_eq!(read(&packed.bytes, 1.0), [0.0, 0.0, -2.0]);
    }
}
