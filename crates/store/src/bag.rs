//! Bags of ROS 2: databases of others with messages of many topics.

use rusqlite::{Connection, MAIN_DB};

use realgap_core::error::{Error, Result};

/// First bytes of a database.
const SIGNATURE: &[u8] = b"SQLite format 3\0";
/// Where a database says whether later changes lie in a file beside it.
const VERSIONS: std::ops::Range<usize> = 18..20;

fn refused(error: &rusqlite::Error) -> Error {
    Error::invalid("the bag cannot be read as a database")
        .found(error)
        .hint("a bag that was cut off is mended by `ros2 bag reindex`; one that is packed is unpacked by `zstd -d`")
}

/// One message of a bag.
#[derive(Debug, Clone, Copy)]
pub struct BagMessage<'a> {
    pub topic: &'a str,
    /// Name of its type.
    pub kind: &'a str,
    /// How it is coded, e.g. `cdr`.
    pub encoding: &'a str,
    /// When it was recorded, nanoseconds.
    pub log_time_ns: i64,
    pub data: &'a [u8],
}

/// Calls `each` with every message of the bag that these bytes are, by time.
///
/// # Errors
/// Bytes that are no such database, or a damaged one; what `each` refuses.
pub fn read_bag(
    mut bytes: Vec<u8>,
    each: &mut dyn FnMut(&BagMessage<'_>) -> Result<()>,
) -> Result<()> {
    if !bytes.starts_with(SIGNATURE) {
        return Err(Error::invalid("this is no bag of ROS 2")
            .found("other first bytes")
            .allowed("a SQLite database"));
    }
    // In memory there is no file beside it.
    if let Some(versions) = bytes.get_mut(VERSIONS) {
        versions.fill(1);
    }
    let sql = |error: rusqlite::Error| refused(&error);
    let mut bag = Connection::open_in_memory().map_err(sql)?;
    bag.deserialize_read_exact(MAIN_DB, bytes.as_slice(), bytes.len(), true)
        .map_err(sql)?;
    drop(bytes);
    // A view could compute for ever.
    let tables = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')";
    let count: i64 = bag.query_row(tables, [], |row| row.get(0)).map_err(sql)?;
    if count != 2 {
        return Err(Error::invalid("this database is no bag of ROS 2")
            .allowed("the tables `topics` and `messages`"));
    }
    let messages = "SELECT t.name, t.type, t.serialization_format, m.timestamp, m.data \
                    FROM messages AS m JOIN topics AS t ON t.id = m.topic_id ORDER BY m.timestamp, m.id";
    let mut messages = bag.prepare(messages).map_err(sql)?;
    let mut rows = messages.query([]).map_err(sql)?;
    while let Some(row) = rows.next().map_err(sql)? {
        let text = |column: usize| Some(row.get_ref(column).ok()?.as_str().ok()?.to_owned());
        let data = row.get_ref(4).ok();
        let data = data.and_then(|data| data.as_blob().ok());
        let parts = (text(0), text(1), text(2), row.get::<_, i64>(3).ok(), data);
        let (Some(topic), Some(kind), Some(encoding), Some(log_ns), Some(data)) = parts else {
            return Err(Error::invalid("the bag is damaged")
                .found("a message without name, type, coding, time or content"));
        };
        each(&BagMessage {
            topic: &topic,
            kind: &kind,
            encoding: &encoding,
            log_time_ns: log_ns,
            data,
        })?;
    }
    Ok(())
}
