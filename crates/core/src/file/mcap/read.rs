//! Reads all messages of an MCAP file in the order of the file.

use std::collections::BTreeMap;
use std::io::Read;

use super::{MAGIC, opcode};
use crate::error::{Error, Result};
use crate::file::byte_reader::ByteReader;

/// The largest size of one decompressed chunk, and of all chunks together, bytes: a small file must not expand without limit.
pub(super) const MOST_IN_CHUNK: u64 = 256_000_000;
const MOST_IN_ALL: u64 = 4_000_000_000;
/// The largest decompression window that a file may request, bytes.
const MOST_WINDOW: u64 = 1 << 27;

/// A channel: a topic with one type and encoding of messages.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Channel {
    /// The name of the topic.
    pub topic: String,
    /// The encoding of the messages: `cdr`, `json`, …
    pub encoding: String,
    /// The name of the message type; empty if the file does not name it.
    pub schema: String,
}

/// One recorded message.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    pub channel: &'a Channel,
    /// The time at which the message was recorded, nanoseconds.
    pub log_time_ns: u64,
    pub data: &'a [u8],
}

/// The state of reading: the schemas and channels known so far, and the number of decompressed bytes.
pub(super) struct Reader<'f> {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    unpacked: u64,
    /// The largest number of decompressed bytes.
    most_unpacked: u64,
    each: &'f mut dyn FnMut(&Message<'_>) -> Result<()>,
}

/// Calls `each` with every message.
///
/// # Errors
/// Bytes that are not an MCAP file, or only a part of one; errors of `each`.
pub fn read_mcap(bytes: &[u8], each: &mut dyn FnMut(&Message<'_>) -> Result<()>) -> Result<()> {
    let mut input = ByteReader::new(bytes);
    if input.take(MAGIC.len()) != Some(MAGIC) {
        return Err(Error::invalid("this is no MCAP file")
            .found("other first bytes")
            .allowed("a file that begins with the signature of MCAP"));
    }
    let mut reader = Reader::new(MOST_IN_ALL, each);
    loop {
        let at = input.at();
        let Some((kind, content)) = record(&mut input) else {
            return Err(cut_off(at));
        };
        match kind {
            opcode::CHUNK => reader.chunk(content, at)?,
            // The records before the footer repeat earlier records; only the signature follows the footer.
            opcode::FOOTER if input.rest() == MAGIC => return Ok(()),
            opcode::FOOTER => return Err(cut_off(at)),
            _ => reader.record(kind, content, at)?,
        }
    }
}

/// The kind and the content of the next record.
fn record<'a>(input: &mut ByteReader<'a>) -> Option<(u8, &'a [u8])> {
    let kind = input.u8()?;
    let length = usize::try_from(input.u64_le()?).ok()?;
    Some((kind, input.take(length)?))
}

pub(super) fn cut_off(at: usize) -> Error {
    Error::invalid("the MCAP file is cut off")
        .found(format!("an incomplete last record, at byte {at}"))
        .hint("`mcap recover` of Foxglove's command line keeps the complete records")
}

fn broken(what: &str, at: usize) -> Error {
    Error::invalid("the MCAP file is damaged").found(format!("{what} at byte {at}"))
}

fn string(input: &mut ByteReader<'_>) -> Option<String> {
    let length = input.u32_le()?;
    let bytes = input.take(usize::try_from(length).ok()?)?;
    String::from_utf8(bytes.to_vec()).ok()
}

impl<'f> Reader<'f> {
    /// A reader that knows no channel yet.
    pub(super) fn new(
        most_unpacked: u64,
        each: &'f mut dyn FnMut(&Message<'_>) -> Result<()>,
    ) -> Self {
        Self {
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            unpacked: 0,
            most_unpacked,
            each,
        }
    }

    pub(super) fn record(&mut self, kind: u8, content: &[u8], at: usize) -> Result<()> {
        let mut input = ByteReader::new(content);
        match kind {
            opcode::SCHEMA => {
                let schema = input.u16_le().zip(string(&mut input));
                let (id, name) = schema.ok_or_else(|| broken("a schema", at))?;
                self.schemas.insert(id, name);
            }
            opcode::CHANNEL => {
                let (id, channel) = self
                    .channel(&mut input)
                    .ok_or_else(|| broken("a channel", at))?;
                self.channels.insert(id, channel);
            }
            opcode::MESSAGE => {
                let head = (
                    input.u16_le(),
                    input.u32_le(),
                    input.u64_le(),
                    input.u64_le(),
                );
                let (Some(channel), Some(_), Some(log_time_ns), Some(_)) = head else {
                    return Err(broken("a message", at));
                };
                let Some(channel) = self.channels.get(&channel) else {
                    return Err(broken("a message of an unknown channel", at));
                };
                let data = input.rest();
                (self.each)(&Message {
                    channel,
                    log_time_ns,
                    data,
                })?;
            }
            // Indices, attachments, metadata, and records of later versions of the format are skipped.
            _ => {}
        }
        Ok(())
    }

    fn channel(&self, input: &mut ByteReader<'_>) -> Option<(u16, Channel)> {
        let id = input.u16_le()?;
        let schema = input.u16_le()?;
        let channel = Channel {
            topic: string(input)?,
            encoding: string(input)?,
            schema: self.schemas.get(&schema).cloned().unwrap_or_default(),
        };
        Some((id, channel))
    }

    pub(super) fn chunk(&mut self, content: &[u8], at: usize) -> Result<()> {
        let mut input = ByteReader::new(content);
        let mut head = || {
            input.take(16)?;
            let size = input.u64_le()?;
            let crc = input.u32_le()?;
            let compression = string(&mut input)?;
            let length = usize::try_from(input.u64_le()?).ok()?;
            Some((size, crc, compression, input.take(length)?))
        };
        let (size, crc, compression, packed) = head().ok_or_else(|| broken("a chunk", at))?;
        self.unpacked = self.unpacked.saturating_add(size);
        if size > MOST_IN_CHUNK || self.unpacked > self.most_unpacked {
            return Err(
                Error::invalid("the MCAP file is too large when decompressed")
                    .found(format!("a chunk of {size} bytes at byte {at}"))
                    .allowed(format!(
                        "at most {MOST_IN_CHUNK} bytes a chunk, {} in all",
                        self.most_unpacked
                    ))
                    .hint(
                        "`mcap filter` of Foxglove's command line keeps the topics that are needed",
                    ),
            );
        }
        let unpacked;
        let records = match compression.as_str() {
            "" => packed,
            "zstd" => {
                let decoder = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(
                    packed,
                    MOST_WINDOW,
                );
                unpacked = decoder.ok().and_then(|decoder| unpack(decoder, size));
                unpacked
                    .as_deref()
                    .ok_or_else(|| broken("a compressed chunk", at))?
            }
            "lz4" => {
                unpacked = unpack(lz4_flex::frame::FrameDecoder::new(packed), size);
                unpacked
                    .as_deref()
                    .ok_or_else(|| broken("a compressed chunk", at))?
            }
            other => {
                return Err(Error::invalid("the MCAP file has an unknown compression")
                    .found(other)
                    .allowed("zstd, lz4 or none"));
            }
        };
        if crc != 0 && crc32fast::hash(records) != crc {
            return Err(broken("a chunk with a wrong checksum", at));
        }
        let mut input = ByteReader::new(records);
        while !input.is_empty() {
            let (kind, content) = record(&mut input).ok_or_else(|| broken("a chunk", at))?;
            self.record(kind, content, at)?;
        }
        Ok(())
    }
}

/// Decompresses a stream; `None` if its length differs from the stated `size`.
fn unpack(stream: impl Read, size: u64) -> Option<Vec<u8>> {
    let mut all = Vec::new();
    stream.take(size + 1).read_to_end(&mut all).ok()?;
    (all.len() as u64 == size).then_some(all)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::read_mcap;
    use crate::file::{McapWriter, Topic};
    use crate::random::Once;

    /// The seed for the positions where the file is cut.
    const SEED: u64 = 30;

    #[test]
    fn a_truncated_file_is_refused_wherever_it_is_cut() {
        let mut writer = McapWriter::new(vec![Topic::Pose("/robot".to_owned())]);
        for k in 0..200 {
            writer.message(0, k, &serde_json::json!({ "message": k.to_string() }));
        }
        let bytes = writer.finish();
        let mut count = 0;
        let mut each = |_: &super::Message<'_>| {
            count += 1;
            Ok(())
        };
        read_mcap(&bytes, &mut each).unwrap();
        assert_eq!(count, 200);
        let mut rng = Once::Subset.generator(SEED);
        let cuts = (0..200).map(|_| rng.random_range(0..bytes.len()));
        for length in cuts.chain(bytes.len() - 20..bytes.len()) {
            assert!(read_mcap(&bytes[..length], &mut |_| Ok(())).is_err());
        }
    }
}
