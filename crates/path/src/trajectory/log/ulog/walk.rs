//! Walks through the messages of a ULog, and finds the fields of a topic in the bytes of its messages.

use std::collections::HashMap;

use realgap_core::error::{Error, Result};

/// The first bytes of a log; a version and the time of its start follow.
pub(super) const MAGIC: &[u8] = b"ULog\x01\x12\x35";
const HEADER: usize = 16;
/// Structures within structures.
const MOST_NESTED: usize = 8;
/// Fields of one message, with those of its structures and lists.
const MOST_FIELDS: usize = 4096;

/// The start of the names of fields that only fill up.
const PADDING: &str = "_padding";

/// A number of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// A field with its place behind the number of its topic.
#[derive(Debug, Clone)]
struct Field {
    name: String,
    at: usize,
    number: Number,
}

/// The layout of the messages of a topic.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    fields: Vec<Field>,
    size: usize,
}

impl Number {
    fn of(kind: &str) -> Option<Self> {
        Some(match kind {
            "int8_t" => Self::I8,
            "uint8_t" | "bool" | "char" => Self::U8,
            "int16_t" => Self::I16,
            "uint16_t" => Self::U16,
            "int32_t" => Self::I32,
            "uint32_t" => Self::U32,
            "int64_t" => Self::I64,
            "uint64_t" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn read(self, bytes: &[u8]) -> Option<f64> {
        let two = || bytes.first_chunk().copied();
        let four = || bytes.first_chunk().copied();
        let eight = || bytes.first_chunk().copied();
        Some(match self {
            Self::I8 => f64::from(*bytes.first()? as i8),
            Self::U8 => f64::from(*bytes.first()?),
            Self::I16 => f64::from(i16::from_le_bytes(two()?)),
            Self::U16 => f64::from(u16::from_le_bytes(two()?)),
            Self::I32 => f64::from(i32::from_le_bytes(four()?)),
            Self::U32 => f64::from(u32::from_le_bytes(four()?)),
            Self::F32 => f64::from(f32::from_le_bytes(four()?)),
            Self::I64 => i64::from_le_bytes(eight()?) as f64,
            Self::U64 => u64::from_le_bytes(eight()?) as f64,
            Self::F64 => f64::from_le_bytes(eight()?),
        })
    }
}

impl Layout {
    /// The value of a field, e.g. `q[0]`; `None` for a field that the topic does not have.
    pub(super) fn value(&self, name: &str, message: &[u8]) -> Option<f64> {
        let field = self.fields.iter().find(|field| field.name == name)?;
        field.number.read(message.get(field.at..)?)
    }

    /// The time of a message, microseconds.
    pub(super) fn time_us(&self, message: &[u8]) -> Option<u64> {
        let field = self.fields.iter().find(|field| field.name == "timestamp")?;
        let bytes = message.get(field.at..)?.first_chunk()?;
        (field.number == Number::U64).then(|| u64::from_le_bytes(*bytes))
    }

    /// The number of elements of a list.
    pub(super) fn count(&self, list: &str) -> usize {
        let is_element = |field: &&Field| {
            let rest = field.name.strip_prefix(list);
            rest.is_some_and(|rest| rest.starts_with('['))
        };
        self.fields.iter().filter(is_element).count()
    }
}

/// What the definitions state: the text of each structure.
#[derive(Default)]
struct Structures(HashMap<String, String>);

impl Structures {
    /// The layout of a structure; `None` if it is not stated, or endless.
    fn layout(&self, name: &str) -> Option<Layout> {
        let mut layout = Layout::default();
        self.push(name, "", 0, &mut layout)?;
        // What fills up the end of a structure is not logged.
        while let Some(last) = layout.fields.last()
            && last.name.starts_with(PADDING)
        {
            layout.size = last.at;
            layout.fields.pop();
        }
        Some(layout)
    }

    fn push(&self, name: &str, before: &str, depth: usize, layout: &mut Layout) -> Option<()> {
        if depth > MOST_NESTED {
            return None;
        }
        for field in self
            .0
            .get(name)?
            .split(';')
            .filter(|field| !field.is_empty())
        {
            let (kind, name) = field.trim().split_once(' ')?;
            let (kind, count) = match kind.split_once('[') {
                Some((kind, count)) => (kind, Some(count.strip_suffix(']')?.parse().ok()?)),
                None => (kind, None),
            };
            for index in 0..count.unwrap_or(1_usize) {
                if layout.fields.len() > MOST_FIELDS {
                    return None;
                }
                let name = match count {
                    Some(_) => format!("{before}{name}[{index}]"),
                    None => format!("{before}{name}"),
                };
                match Number::of(kind) {
                    Some(number) => {
                        layout.fields.push(Field {
                            name,
                            at: layout.size,
                            number,
                        });
                        layout.size += number.size();
                    }
                    None => self.push(kind, &format!("{name}."), depth + 1, layout)?,
                }
            }
        }
        Some(())
    }
}

/// One message of a topic.
pub(super) struct Message<'a> {
    pub(super) topic: &'a str,
    pub(super) layout: &'a Layout,
    pub(super) data: &'a [u8],
}

/// How a log ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct End {
    /// True if the last message is cut off: the vehicle lost its power, or the card was pulled.
    pub(super) is_cut: bool,
    /// Time that was not recorded, because the card was too slow, milliseconds.
    pub(super) lost_ms: u64,
}

fn damaged(at: usize, found: &str) -> Error {
    Error::invalid("the log is damaged")
        .found(format!("{found}, at byte {at}"))
        .hint("copy it from the vehicle once more")
}

/// Calls `each` with every message of a topic. A second instance of a topic is called `NAME/1`.
///
/// # Errors
/// Bytes that are no log, a damaged one, errors of `each`.
pub(super) fn walk(bytes: &[u8], each: &mut dyn FnMut(&Message<'_>) -> Result<()>) -> Result<End> {
    if !bytes.starts_with(MAGIC) || bytes.len() < HEADER {
        return Err(Error::invalid("this is no ULog")
            .allowed("a file that begins with the signature of ULog"));
    }
    let mut structures = Structures::default();
    let mut topics: HashMap<u16, (String, Layout)> = HashMap::new();
    let mut end = End::default();
    let mut at = HEADER;
    while at < bytes.len() {
        let head = bytes.get(at..at + 3);
        let size = head.map_or(0, |head| {
            usize::from(u16::from_le_bytes([head[0], head[1]]))
        });
        let (Some(head), Some(body)) = (head, bytes.get(at + 3..at + 3 + size)) else {
            end.is_cut = true;
            break;
        };
        let text = |bytes: &[u8]| {
            let text = String::from_utf8(bytes.to_vec());
            text.map_err(|_| damaged(at, "a name that is no text"))
        };
        match head[2] {
            // Bits of features without which the log cannot be understood; the first says that data are appended.
            b'B' => {
                let bits = body.get(8..16).ok_or_else(|| damaged(at, "short flags"))?;
                if bits[0] & !1 != 0 || bits[1..].iter().any(|bits| *bits != 0) {
                    return Err(Error::invalid("the log has features that are not known here")
                        .hint("write its topics as CSV: pip install pyulog; ulog2csv -m vehicle_local_position FILE.ulg"));
                }
            }
            b'F' => {
                let text = text(body)?;
                let (name, fields) = (text.split_once(':'))
                    .ok_or_else(|| damaged(at, "a structure without fields"))?;
                structures.0.insert(name.to_owned(), fields.to_owned());
            }
            b'A' => {
                let [instance, low, high, name @ ..] = body else {
                    return Err(damaged(at, "a short subscription"));
                };
                let name = text(name)?;
                let layout = structures.layout(&name);
                let layout = layout.ok_or_else(|| damaged(at, "a topic without its structure"))?;
                let name = match instance {
                    0 => name,
                    instance => format!("{name}/{instance}"),
                };
                topics.insert(u16::from_le_bytes([*low, *high]), (name, layout));
            }
            b'D' => {
                let [low, high, data @ ..] = body else {
                    return Err(damaged(at, "a short message"));
                };
                let number = u16::from_le_bytes([*low, *high]);
                let (topic, layout) = topics
                    .get(&number)
                    .ok_or_else(|| damaged(at, "a message of a topic that is not stated"))?;
                if data.len() < layout.size {
                    return Err(damaged(at, "a message that is shorter than its fields"));
                }
                each(&Message {
                    topic,
                    layout,
                    data,
                })?;
            }
            b'O' => {
                let ms = body.first_chunk().copied().map_or(0, u16::from_le_bytes);
                end.lost_ms += u64::from(ms);
            }
            b'I' | b'M' | b'P' | b'Q' | b'R' | b'S' | b'L' | b'C' => {}
            other => {
                return Err(damaged(at, &format!("a message of the kind {other:#04x}")));
            }
        }
        at += 3 + size;
    }
    Ok(end)
}
