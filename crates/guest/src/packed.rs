//! Arrays of numbers in answers: a list, or the bytes of the numbers in base64, which is much faster to write and to read.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};

/// The values of one channel.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Values(pub Vec<f64>);

/// Key of an object that holds the bytes of 64-bit floats, the least significant byte first, in base64.
const PACKED: &str = "base64_f64";

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Values;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a list of numbers or {{\"{PACKED}\": \"...\"}}")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Values, A::Error> {
                let mut values = Vec::with_capacity(list.size_hint().unwrap_or(0));
                while let Some(value) = list.next_element::<f64>()? {
                    values.push(value);
                }
                Ok(Values(values))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Values, A::Error> {
                let Some((key, text)) = map.next_entry::<String, String>()? else {
                    return Err(A::Error::missing_field(PACKED));
                };
                if key != PACKED {
                    return Err(A::Error::unknown_field(&key, &[PACKED]));
                }
                if map.next_key::<String>()?.is_some() {
                    return Err(A::Error::custom("more than one packed array"));
                }
                unpacked(&text).map(Values).map_err(A::Error::custom)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// The numbers whose bytes stand in this text.
fn unpacked(text: &str) -> Result<Vec<f64>, String> {
    let bytes = decoded(text.as_bytes())?;
    let (numbers, rest) = bytes.as_chunks::<8>();
    if !rest.is_empty() {
        return Err(format!(
            "{} bytes are no whole number of 64-bit floats",
            bytes.len()
        ));
    }
    Ok(numbers
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect())
}

/// Bytes of base64 with the usual alphabet.
fn decoded(text: &[u8]) -> Result<Vec<u8>, String> {
    let digit = |byte: u8| -> Result<u32, String> {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(format!("`{}` is no digit of base64", char::from(byte))),
        };
        Ok(u32::from(value))
    };
    let padding = text.iter().rev().take_while(|byte| **byte == b'=').count();
    let digits = &text[..text.len() - padding.min(2)];
    if !text.len().is_multiple_of(4) || digits.len() % 4 == 1 {
        return Err(format!("{} characters are no base64", text.len()));
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0;
        for byte in group {
            bits = bits << 6 | digit(*byte)?;
        }
        bits <<= 6 * (4 - group.len());
        let [_, a, b, c] = bits.to_be_bytes();
        bytes.extend_from_slice(&[a, b, c][..group.len() - 1]);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_and_listed_numbers_are_the_same() {
        // base64.b64encode(struct.pack("<3d", 1.0, -2.5, 0.1)) of Python 3.
        let packed = r#"{"base64_f64": "AAAAAAAA8D8AAAAAAAAEwJqZmZmZmbk/"}"#;
        let packed: Values = serde_json::from_str(packed).unwrap();
        let listed: Values = serde_json::from_str("[1, -2.5, 0.1]").unwrap();
        assert_eq!(packed, listed);
    }

    #[test]
    fn bytes_that_are_no_numbers_are_refused() {
        let refused = |text: &str| {
            serde_json::from_str::<Values>(&format!("{{\"base64_f64\": \"{text}\"}}")).is_err()
        };
        assert!(refused("AAAA") && refused("A") && refused("AAAAAAAA8D8!"));
        assert!(serde_json::from_str::<Values>("[1, null]").is_err());
    }
}
