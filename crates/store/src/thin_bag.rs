//! Reads only some topics of a bag of any size: SQLite reads the pages of their messages from the file, and what is kept is a small bag
//! in memory.

use std::io::Read as _;
use std::path::Path;

use rusqlite::{Connection, MAIN_DB, OpenFlags, params};

use super::bag::{closed, mark_unfinished, must_be_bag, must_be_whole, refused, unclosed};
use realgap_core::error::{Error, Result};

/// The bytes of a bag with the messages of the wanted topics of the bag at `path`; `is_wanted` is asked with the encoding and the type
/// of each topic. A bag that its recorder has not closed is closed in a temporary copy.
///
/// # Errors
/// A file that cannot be read, or is no whole bag; more than `limit` bytes of wanted messages.
pub fn read_thin_bag(
    path: &Path,
    limit: u64,
    is_wanted: &dyn Fn(&str, &str) -> bool,
) -> Result<Vec<u8>> {
    if unclosed(path).is_empty() {
        return thin(path, limit, is_wanted).map_err(|error| error.at_file(path));
    }
    closed(path, |copy, is_unfinished| {
        let mut bytes = thin(copy, limit, is_wanted).map_err(|error| error.at_file(path))?;
        if is_unfinished {
            mark_unfinished(&mut bytes);
        }
        Ok(bytes)
    })
}

/// The name under which SQLite opens a file that nobody changes, and writes nothing beside it.
fn unchanging(path: &Path) -> String {
    let mut name = String::from("file:");
    for byte in path.to_string_lossy().replace('\\', "/").bytes() {
        match byte {
            b'/' | b'.' | b'_' | b'-' | b':' => name.push(char::from(byte)),
            _ if byte.is_ascii_alphanumeric() => name.push(char::from(byte)),
            _ => name.push_str(&format!("%{byte:02x}")),
        }
    }
    name + "?immutable=1"
}

fn thin(path: &Path, limit: u64, is_wanted: &dyn Fn(&str, &str) -> bool) -> Result<Vec<u8>> {
    let fail = |error: std::io::Error| Error::io("read the bag", path, &error);
    let mut file = std::fs::File::open(path).map_err(fail)?;
    let mut header = [0; 100];
    let is_header = file.read_exact(&mut header).is_ok();
    let size = file.metadata().map_err(fail)?.len();
    must_be_whole(if is_header { &header } else { &[] }, size)?;
    let sql = |error: rusqlite::Error| refused(&error);
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
    let bag = Connection::open_with_flags(unchanging(path), flags).map_err(sql)?;
    bag.pragma_update(None, "trusted_schema", false)
        .map_err(sql)?;
    must_be_bag(&bag)?;
    let mut kept = Connection::open_in_memory().map_err(sql)?;
    let tables = "CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
        CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
        BEGIN";
    kept.execute_batch(tables).map_err(sql)?;
    let topics = "SELECT id, name, type, serialization_format FROM topics";
    let mut topics = bag.prepare(topics).map_err(sql)?;
    let mut rows = topics.query([]).map_err(sql)?;
    let mut wanted = Vec::new();
    while let Some(row) = rows.next().map_err(sql)? {
        let text = |column: usize| row.get::<_, String>(column).map_err(sql);
        let id: i64 = row.get(0).map_err(sql)?;
        let (name, kind, encoding) = (text(1)?, text(2)?, text(3)?);
        if is_wanted(&encoding, &kind) {
            wanted.push(id);
            let topic = "INSERT INTO topics VALUES (?1, ?2, ?3, ?4)";
            kept.execute(topic, params![id, name, kind, encoding])
                .map_err(sql)?;
        }
    }
    // Of other topics, the large messages are not even read.
    let messages = "SELECT id, topic_id, timestamp FROM messages";
    let mut messages = bag.prepare(messages).map_err(sql)?;
    let mut content = bag
        .prepare("SELECT data FROM messages WHERE id = ?1")
        .map_err(sql)?;
    let mut keep = kept
        .prepare("INSERT INTO messages VALUES (?1, ?2, ?3, ?4)")
        .map_err(sql)?;
    let mut rows = messages.query([]).map_err(sql)?;
    let mut bytes = 0;
    while let Some(row) = rows.next().map_err(sql)? {
        let (id, topic): (i64, i64) = (row.get(0).map_err(sql)?, row.get(1).map_err(sql)?);
        if !wanted.contains(&topic) {
            continue;
        }
        let time: i64 = row.get(2).map_err(sql)?;
        let data: Vec<u8> = content.query_row([id], |row| row.get(0)).map_err(sql)?;
        bytes += data.len() as u64;
        if bytes > limit {
            return Err(
                Error::invalid("the poses, joints and commands of this file are too many")
                    .allowed(format!("at most {limit} bytes of them"))
                    .hint("`ros2 bag convert` keeps the topics and times that are needed"),
            );
        }
        keep.execute(params![id, topic, time, data]).map_err(sql)?;
    }
    drop(keep);
    kept.execute_batch("COMMIT").map_err(sql)?;
    let small = kept.serialize(MAIN_DB).map_err(sql)?;
    Ok(small.to_vec())
}
