//! Reads only some topics of an MCAP file of any size: the file is streamed chunk by chunk, and what is kept is a small MCAP file in memory.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;

use super::read::{Channel, MOST_IN_CHUNK, Reader, cut_off};
use super::write::{Content, push};
use super::{MAGIC, opcode};
use crate::error::{Error, Result};

/// The largest size of all decompressed chunks together, bytes.
const MOST_IN_ALL: u64 = 1 << 40;

/// The file being made, and the numbers of the channels in it.
struct Thin {
    bytes: Vec<u8>,
    numbers: BTreeMap<Channel, u16>,
}

impl Thin {
    /// The number of a channel, which is written before its first message.
    fn number(&mut self, channel: &Channel) -> Option<u16> {
        if let Some(number) = self.numbers.get(channel) {
            return Some(*number);
        }
        let number = u16::try_from(self.numbers.len() + 1).ok()?;
        let schema = Content::default().u16(number).text(&channel.schema);
        push(&mut self.bytes, opcode::SCHEMA, &schema.text("").u32(0));
        let topic = Content::default().u16(number).u16(number);
        let topic = topic.text(&channel.topic).text(&channel.encoding).u32(0);
        push(&mut self.bytes, opcode::CHANNEL, &topic);
        self.numbers.insert(channel.clone(), number);
        Some(number)
    }
}

/// The messages of the wanted channels in the file at `path`, as the bytes of an MCAP file. Memory is that of the largest chunk and of
/// what is kept.
///
/// # Errors
/// A file that cannot be read, or is no whole MCAP file; more than `limit` bytes of wanted messages.
pub fn read_thin_mcap(
    path: &Path,
    limit: u64,
    is_wanted: &dyn Fn(&Channel) -> bool,
) -> Result<Vec<u8>> {
    let fail = |error: std::io::Error| Error::io("read the trajectory", path, &error);
    let file = std::fs::File::open(path).map_err(fail)?;
    let length = file.metadata().map_err(fail)?.len();
    let mut input = BufReader::with_capacity(1 << 20, file);
    let mut thin = Thin {
        bytes: MAGIC.to_vec(),
        numbers: BTreeMap::new(),
    };
    let mut first = [0; MAGIC.len()];
    if input.read_exact(&mut first).is_err() || first != *MAGIC {
        return Err(Error::invalid("this is no MCAP file")
            .at_file(path)
            .allowed("a file that begins with the signature of MCAP"));
    }
    let mut each = |message: &super::read::Message<'_>| {
        if !is_wanted(message.channel) {
            return Ok(());
        }
        let number = thin.number(message.channel);
        let number = number.ok_or_else(|| Error::invalid("too many channels"))?;
        let content = Content::default().u16(number).u32(0);
        let content = content.u64(message.log_time_ns).u64(message.log_time_ns);
        push(&mut thin.bytes, opcode::MESSAGE, &content.raw(message.data));
        if thin.bytes.len() as u64 > limit {
            return Err(
                Error::invalid("the poses, joints and commands of this file are too many")
                    .allowed(format!("at most {limit} bytes of them"))
                    .hint("`mcap filter` of Foxglove's command line keeps the topics and times that are needed"),
            );
        }
        Ok(())
    };
    let mut reader = Reader::new(MOST_IN_ALL, &mut each);
    let mut content = Vec::new();
    let mut at = MAGIC.len() as u64;
    loop {
        let place = usize::try_from(at).unwrap_or(usize::MAX);
        let mut head = [0; 9];
        let is_whole = input.read_exact(&mut head).is_ok();
        let [kind, size @ ..] = head;
        let size = u64::from_le_bytes(size);
        let end = at.saturating_add(9).saturating_add(size);
        if !is_whole || end > length {
            return Err(cut_off(place).at_file(path));
        }
        match kind {
            opcode::CHUNK | opcode::SCHEMA | opcode::CHANNEL | opcode::MESSAGE | opcode::FOOTER => {
                if size > MOST_IN_CHUNK {
                    return Err(Error::invalid("a record of the MCAP file is too large")
                        .at_file(path)
                        .found(format!("{size} bytes at byte {at}"))
                        .allowed(format!("at most {MOST_IN_CHUNK} bytes")));
                }
                content.clear();
                let mut part = input.by_ref().take(size);
                part.read_to_end(&mut content).map_err(fail)?;
            }
            _ => input
                .seek_relative(i64::try_from(size).unwrap_or(i64::MAX))
                .map_err(fail)?,
        }
        match kind {
            opcode::CHUNK => reader.chunk(&content, place).map_err(|e| e.at_file(path))?,
            opcode::FOOTER => {
                let is_end = input.fill_buf().map_err(fail)? == MAGIC;
                if !is_end {
                    return Err(cut_off(place).at_file(path));
                }
                break;
            }
            opcode::SCHEMA | opcode::CHANNEL | opcode::MESSAGE => {
                let done = reader.record(kind, &content, place);
                done.map_err(|e| e.at_file(path))?;
            }
            _ => {}
        }
        at = end;
    }
    let footer = Content::default().u64(0).u64(0).u32(0);
    push(&mut thin.bytes, opcode::FOOTER, &footer);
    thin.bytes.extend(MAGIC);
    Ok(thin.bytes)
}
