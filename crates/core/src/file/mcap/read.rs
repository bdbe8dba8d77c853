//! Every message of a file, in its order.

use std::collections::BTreeMap;
use std::io::Read;

use super::{MAGIC, opcode};
use crate::error::{Error, Result};
use crate::file::octet::Octets;

/// Most bytes of one chunk, unpacked, and of all chunks together: what a small file may grow to.
const MOST_IN_CHUNK: u64 = 256_000_000;
const MOST_IN_ALL: u64 = 4_000_000_000;
/// Largest window that packed bytes may ask for.
const MOST_WINDOW: u64 = 1 << 27;

/// Where messages of one kind are said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    pub topic: String,
    /// How messages are coded: `cdr`, `json`, …
    pub encoding: String,
    /// Name of their type; empty where the file names none.
    pub schema: String,
}

/// One message.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    pub channel: &'a Channel,
    /// When it was recorded, nanoseconds.
    pub log_time_ns: u64,
    pub data: &'a [u8],
}

/// What has been read so far.
struct Reader<'f> {
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    unpacked: u64,
    each: &'f mut dyn FnMut(&Message<'_>) -> Result<()>,
}

/// Calls `each` with every message.
///
/// # Errors
/// Bytes that are no MCAP file, or not all of one; what `each` refuses.
pub fn read_mcap(bytes: &[u8], each: &mut dyn FnMut(&Message<'_>) -> Result<()>) -> Result<()> {
    let mut octets = Octets::new(bytes);
    if octets.take(MAGIC.len()) != Some(MAGIC) {
        return Err(Error::invalid("this is no MCAP file")
            .found("other first bytes")
            .allowed("a file that begins with the signature of MCAP"));
    }
    let mut reader = Reader {
        schemas: BTreeMap::new(),
        channels: BTreeMap::new(),
        unpacked: 0,
        each,
    };
    loop {
        let at = octets.at();
        let Some((kind, content)) = record(&mut octets) else {
            return Err(cut_off(at));
        };
        match kind {
            opcode::CHUNK => reader.chunk(content, at)?,
            // What stands before it repeats what was said; behind it comes the signature again, and nothing else.
            opcode::FOOTER if octets.rest() == MAGIC => return Ok(()),
            opcode::FOOTER => return Err(cut_off(at)),
            _ => reader.record(kind, content, at)?,
        }
    }
}

/// Kind and content of the next record.
fn record<'a>(octets: &mut Octets<'a>) -> Option<(u8, &'a [u8])> {
    let kind = octets.u8()?;
    let length = usize::try_from(octets.u64_le()?).ok()?;
    Some((kind, octets.take(length)?))
}

fn cut_off(at: usize) -> Error {
    Error::invalid("the MCAP file is cut off")
        .found(format!("a last record that is not whole, at byte {at}"))
        .hint("`mcap recover` of Foxglove's command line keeps what was written before")
}

fn broken(what: &str, at: usize) -> Error {
    Error::invalid("the MCAP file is damaged").found(format!("{what} at byte {at}"))
}

fn string(octets: &mut Octets<'_>) -> Option<String> {
    let length = octets.u32_le()?;
    let bytes = octets.take(usize::try_from(length).ok()?)?;
    String::from_utf8(bytes.to_vec()).ok()
}

impl Reader<'_> {
    fn record(&mut self, kind: u8, content: &[u8], at: usize) -> Result<()> {
        let mut octets = Octets::new(content);
        match kind {
            opcode::SCHEMA => {
                let schema = octets.u16_le().zip(string(&mut octets));
                let (id, name) = schema.ok_or_else(|| broken("a schema", at))?;
                self.schemas.insert(id, name);
            }
            opcode::CHANNEL => {
                let (id, channel) = self
                    .channel(&mut octets)
                    .ok_or_else(|| broken("a channel", at))?;
                self.channels.insert(id, channel);
            }
            opcode::MESSAGE => {
                let head = (
                    octets.u16_le(),
                    octets.u32_le(),
                    octets.u64_le(),
                    octets.u64_le(),
                );
                let (Some(channel), Some(_), Some(log_time_ns), Some(_)) = head else {
                    return Err(broken("a message", at));
                };
                let Some(channel) = self.channels.get(&channel) else {
                    return Err(broken("a message of an unknown channel", at));
                };
                let data = octets.rest();
                (self.each)(&Message {
                    channel,
                    log_time_ns,
                    data,
                })?;
            }
            // Indices, attachments, metadata, and what later versions add.
            _ => {}
        }
        Ok(())
    }

    fn channel(&self, octets: &mut Octets<'_>) -> Option<(u16, Channel)> {
        let id = octets.u16_le()?;
        let schema = octets.u16_le()?;
        let channel = Channel {
            topic: string(octets)?,
            encoding: string(octets)?,
            schema: self.schemas.get(&schema).cloned().unwrap_or_default(),
        };
        Some((id, channel))
    }

    fn chunk(&mut self, content: &[u8], at: usize) -> Result<()> {
        let mut octets = Octets::new(content);
        let mut head = || {
            octets.take(16)?;
            let size = octets.u64_le()?;
            let crc = octets.u32_le()?;
            let compression = string(&mut octets)?;
            let length = usize::try_from(octets.u64_le()?).ok()?;
            Some((size, crc, compression, octets.take(length)?))
        };
        let (size, crc, compression, packed) = head().ok_or_else(|| broken("a chunk", at))?;
        self.unpacked = self.unpacked.saturating_add(size);
        if size > MOST_IN_CHUNK || self.unpacked > MOST_IN_ALL {
            return Err(Error::invalid("the MCAP file is too large unpacked")
                .found(format!("a chunk of {size} bytes at byte {at}"))
                .allowed(format!(
                    "at most {MOST_IN_CHUNK} bytes a chunk, {MOST_IN_ALL} in all"
                ))
                .hint(
                    "`mcap filter` of Foxglove's command line keeps the topics that are needed",
                ));
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
                    .ok_or_else(|| broken("a packed chunk", at))?
            }
            "lz4" => {
                unpacked = unpack(lz4_flex::frame::FrameDecoder::new(packed), size);
                unpacked
                    .as_deref()
                    .ok_or_else(|| broken("a packed chunk", at))?
            }
            other => {
                return Err(Error::invalid("the MCAP file is packed in an unknown way")
                    .found(other)
                    .allowed("zstd, lz4 or nothing"));
            }
        };
        if crc != 0 && crc32fast::hash(records) != crc {
            return Err(broken("a chunk whose check sum is wrong", at));
        }
        let mut octets = Octets::new(records);
        while !octets.is_empty() {
            let (kind, content) = record(&mut octets).ok_or_else(|| broken("a chunk", at))?;
            self.record(kind, content, at)?;
        }
        Ok(())
    }
}

/// All of a packed stream, if it is as long as was said.
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

    /// Seed of the places where the file is cut.
    const SEED: u64 = 30;

    #[test]
    fn no_cut_of_a_file_reads_as_a_file() {
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
