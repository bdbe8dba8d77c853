//! Writes an MCAP file in chunks with indices, so that players can jump to any time.

use std::collections::BTreeMap;
use std::io::Write as _;

use serde::Serialize;

use super::foxglove::Topic;
use super::{MAGIC, opcode};

/// A chunk is closed when it holds this many bytes.
const CHUNK_BYTES: usize = 1 << 20;
/// The number of the first channel; each channel's schema has the same number as the channel.
const FIRST_ID: u16 = 1;

/// An MCAP file that is built in memory. Messages must be added in the order of their times.
pub struct McapWriter {
    bytes: Vec<u8>,
    topics: Vec<Topic>,
    /// The records of the open chunk.
    chunk: Vec<u8>,
    /// The times and byte offsets of the open chunk's messages, by channel.
    index: BTreeMap<u16, Vec<(u64, u64)>>,
    chunks: Vec<ChunkIndex>,
    counts: BTreeMap<u16, u64>,
}

struct ChunkIndex {
    times: [u64; 2],
    at: u64,
    length: u64,
    /// The byte offset of each channel's message index.
    message_index: Vec<(u16, u64)>,
    message_index_length: u64,
    compressed: u64,
    uncompressed: u64,
}

/// The content of one record.
#[derive(Default)]
pub(super) struct Content(Vec<u8>);

impl Content {
    pub(super) fn u16(mut self, value: u16) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    pub(super) fn u32(mut self, value: u32) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    pub(super) fn u64(mut self, value: u64) -> Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    pub(super) fn text(mut self, text: &str) -> Self {
        self = self.u32(text.len() as u32);
        self.0.extend(text.as_bytes());
        self
    }

    pub(super) fn raw(mut self, bytes: &[u8]) -> Self {
        self.0.extend(bytes);
        self
    }
}

pub(super) fn push(bytes: &mut Vec<u8>, kind: u8, content: &Content) {
    bytes.push(kind);
    bytes.extend((content.0.len() as u64).to_le_bytes());
    bytes.extend(&content.0);
}

impl McapWriter {
    /// Starts a file with messages of these topics.
    pub fn new(topics: Vec<Topic>) -> Self {
        let mut bytes = MAGIC.to_vec();
        let library = concat!("realgap ", env!("CARGO_PKG_VERSION"));
        push(
            &mut bytes,
            opcode::HEADER,
            &Content::default().text("").text(library),
        );
        let mut writer = Self {
            bytes,
            topics,
            chunk: Vec::new(),
            index: BTreeMap::new(),
            chunks: Vec::new(),
            counts: BTreeMap::new(),
        };
        writer.chunk = writer.channels();
        writer
    }

    fn id(topic: usize) -> u16 {
        FIRST_ID + topic as u16
    }

    /// The records of the schemas and channels of all topics.
    fn channels(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.schemas(&mut bytes);
        self.topics_only(&mut bytes);
        bytes
    }

    fn schemas(&self, bytes: &mut Vec<u8>) {
        for (index, topic) in self.topics.iter().enumerate() {
            let schema = topic.schema().to_string();
            let content = Content::default()
                .u16(Self::id(index))
                .text(topic.schema_name())
                .text("jsonschema")
                .text(&schema);
            push(bytes, opcode::SCHEMA, &content);
        }
    }

    fn topics_only(&self, bytes: &mut Vec<u8>) {
        for (index, topic) in self.topics.iter().enumerate() {
            let content = Content::default()
                .u16(Self::id(index))
                .u16(Self::id(index))
                .text(topic.name())
                .text("json")
                .u32(0);
            push(bytes, opcode::CHANNEL, &content);
        }
    }

    /// Adds a message of the topic with this index in the list.
    pub fn message(&mut self, topic: usize, time_ns: u64, message: &impl Serialize) {
        let id = Self::id(topic);
        let count = self.counts.entry(id).or_default();
        let sequence = *count as u32;
        *count += 1;
        let at = self.chunk.len() as u64;
        self.index.entry(id).or_default().push((time_ns, at));
        let content = Content::default()
            .u16(id)
            .u32(sequence)
            .u64(time_ns)
            .u64(time_ns)
            // Names and numbers can always be serialised, so this never fails.
            .raw(&serde_json::to_vec(message).unwrap_or_default());
        push(&mut self.chunk, opcode::MESSAGE, &content);
        if self.chunk.len() >= CHUNK_BYTES {
            self.close_chunk();
        }
    }

    fn close_chunk(&mut self) {
        let records = std::mem::take(&mut self.chunk);
        let index = std::mem::take(&mut self.index);
        let times = || index.values().flatten().map(|(time_ns, _)| *time_ns);
        let range = [times().min().unwrap_or(0), times().max().unwrap_or(0)];
        let at = self.bytes.len() as u64;
        let (compression, packed) = match packed(&records) {
            Some(packed) => ("lz4", packed),
            None => ("", records.clone()),
        };
        let content = Content::default()
            .u64(range[0])
            .u64(range[1])
            .u64(records.len() as u64)
            .u32(crc32fast::hash(&records))
            .text(compression)
            .u64(packed.len() as u64)
            .raw(&packed);
        push(&mut self.bytes, opcode::CHUNK, &content);
        let length = self.bytes.len() as u64 - at;
        let mut message_index = Vec::new();
        let from = self.bytes.len() as u64;
        for (id, places) in &index {
            message_index.push((*id, self.bytes.len() as u64));
            let mut content = Content::default().u16(*id).u32(16 * places.len() as u32);
            for (time_ns, place) in places {
                content = content.u64(*time_ns).u64(*place);
            }
            push(&mut self.bytes, opcode::MESSAGE_INDEX, &content);
        }
        self.chunks.push(ChunkIndex {
            times: range,
            at,
            length,
            message_index,
            message_index_length: self.bytes.len() as u64 - from,
            compressed: packed.len() as u64,
            uncompressed: records.len() as u64,
        });
    }

    /// Ends the file and returns its bytes.
    pub fn finish(mut self) -> Vec<u8> {
        self.close_chunk();
        push(
            &mut self.bytes,
            opcode::DATA_END,
            &Content::default().u32(0),
        );
        let start = self.bytes.len() as u64;
        let mut groups: Vec<(u8, Vec<u8>)> = Vec::new();
        let mut group = Vec::new();
        self.schemas(&mut group);
        groups.push((opcode::SCHEMA, std::mem::take(&mut group)));
        self.topics_only(&mut group);
        groups.push((opcode::CHANNEL, std::mem::take(&mut group)));
        push(&mut group, opcode::STATISTICS, &self.statistics());
        groups.push((opcode::STATISTICS, std::mem::take(&mut group)));
        for chunk in &self.chunks {
            push(&mut group, opcode::CHUNK_INDEX, &chunk.content());
        }
        groups.push((opcode::CHUNK_INDEX, group));
        let mut offsets = Vec::new();
        for (kind, group) in groups {
            let content = Content(vec![kind])
                .u64(self.bytes.len() as u64)
                .u64(group.len() as u64);
            push(&mut offsets, opcode::SUMMARY_OFFSET, &content);
            self.bytes.extend(group);
        }
        let offset_start = self.bytes.len() as u64;
        self.bytes.extend(offsets);
        // A checksum of 0 means that it was not computed.
        let footer = Content::default().u64(start).u64(offset_start).u32(0);
        push(&mut self.bytes, opcode::FOOTER, &footer);
        self.bytes.extend(MAGIC);
        self.bytes
    }

    fn statistics(&self) -> Content {
        let first = self.chunks.iter().map(|chunk| chunk.times[0]).min();
        let last = self.chunks.iter().map(|chunk| chunk.times[1]).max();
        let channels = self.topics.len();
        let mut content = Content::default()
            .u64(self.counts.values().sum())
            .u16(channels as u16)
            .u32(channels as u32)
            .u32(0)
            .u32(0)
            .u32(self.chunks.len() as u32)
            .u64(first.unwrap_or(0))
            .u64(last.unwrap_or(0))
            .u32(10 * self.counts.len() as u32);
        for (id, count) in &self.counts {
            content = content.u16(*id).u64(*count);
        }
        content
    }
}

impl ChunkIndex {
    fn content(&self) -> Content {
        let mut content = Content::default()
            .u64(self.times[0])
            .u64(self.times[1])
            .u64(self.at)
            .u64(self.length)
            .u32(10 * self.message_index.len() as u32);
        for (id, at) in &self.message_index {
            content = content.u16(*id).u64(*at);
        }
        let compression = if self.compressed == self.uncompressed {
            ""
        } else {
            "lz4"
        };
        content
            .u64(self.message_index_length)
            .text(compression)
            .u64(self.compressed)
            .u64(self.uncompressed)
    }
}

/// The compressed bytes, if compression makes them fewer.
fn packed(records: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(records).ok()?;
    let packed = encoder.finish().ok()?;
    (packed.len() < records.len()).then_some(packed)
}
