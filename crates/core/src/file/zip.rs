//! Reads the files in a ZIP archive: stored, or packed with deflate.
//! Format: <https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT>.

use std::io::Read;

use super::byte_reader::ByteReader;
use crate::error::{Error, Result};

/// The largest size of all files together, bytes.
const MOST: u64 = 1_000_000_000;
const DIRECTORY_END: &[u8] = b"PK\x05\x06";
const DIRECTORY_ENTRY: &[u8] = b"PK\x01\x02";
const FILE: &[u8] = b"PK\x03\x04";
/// A size or place that stands in a further field, because it needs more than four bytes.
const BEYOND: u64 = 0xffff_ffff;

fn broken(found: &str) -> Error {
    Error::invalid("this is no whole ZIP archive")
        .found(found)
        .allowed("files that are stored or packed with deflate, as numpy.savez and numpy.savez_compressed write them")
}

/// A file in the archive, as its directory states it.
struct Entry {
    name: String,
    method: u16,
    crc: u32,
    packed: u64,
    size: u64,
    at: u64,
}

/// The names and bytes of all files in an archive.
///
/// # Errors
/// Bytes that are no whole archive; files that are too large; another compression.
pub fn read_zip(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>> {
    let end = bytes
        .windows(DIRECTORY_END.len())
        .rposition(|four| four == DIRECTORY_END);
    let end = end.ok_or_else(|| broken("no directory at its end"))?;
    let at = |from: usize| {
        bytes
            .get(end + from..end + from + 4)
            .and_then(|four| four.try_into().ok())
    };
    let start = at(16)
        .map(u32::from_le_bytes)
        .and_then(|start| usize::try_from(start).ok());
    let directory = start.and_then(|start| bytes.get(start..end));
    let mut input = ByteReader::new(directory.ok_or_else(|| broken("a directory outside of it"))?);
    let mut all = Vec::new();
    let mut left = MOST;
    while !input.is_empty() {
        let Some(entry) = entry(&mut input) else {
            break;
        };
        if entry.size > left {
            return Err(Error::invalid("the arrays are too large")
                .found(format!("{} of {} bytes", entry.name, entry.size))
                .allowed(format!("{MOST} bytes in all")));
        }
        left -= entry.size;
        let content = content(bytes, &entry).ok_or_else(|| broken(&entry.name))?;
        all.push((entry.name, content));
    }
    if all.is_empty() {
        return Err(broken("no file in it"));
    }
    Ok(all)
}

fn number<const N: usize>(input: &mut ByteReader<'_>) -> Option<u64> {
    let bytes: [u8; N] = input.array()?;
    let mut wide = [0; 8];
    wide[..N].copy_from_slice(&bytes);
    Some(u64::from_le_bytes(wide))
}

fn entry(input: &mut ByteReader<'_>) -> Option<Entry> {
    if input.take(4)? != DIRECTORY_ENTRY {
        return None;
    }
    let _versions_and_flags: [u8; 6] = input.array()?;
    let method = u16::try_from(number::<2>(input)?).ok()?;
    let _time: [u8; 4] = input.array()?;
    let crc = u32::try_from(number::<4>(input)?).ok()?;
    let (mut packed, mut size) = (number::<4>(input)?, number::<4>(input)?);
    let lengths = [
        number::<2>(input)?,
        number::<2>(input)?,
        number::<2>(input)?,
    ];
    let [name, further, comment] = lengths.map(|length| length as usize);
    let _attributes: [u8; 8] = input.array()?;
    let mut at = number::<4>(input)?;
    let name = String::from_utf8_lossy(input.take(name)?).into_owned();
    let mut fields = ByteReader::new(input.take(further)?);
    let _comment = input.take(comment)?;
    while let (Some(id), Some(length)) = (number::<2>(&mut fields), number::<2>(&mut fields)) {
        let mut field = ByteReader::new(fields.take(length as usize)?);
        if id != 1 {
            continue;
        }
        for value in [&mut size, &mut packed, &mut at] {
            if *value == BEYOND {
                *value = number::<8>(&mut field)?;
            }
        }
    }
    Some(Entry {
        name,
        method,
        crc,
        packed,
        size,
        at,
    })
}

/// The bytes of a file; `None` if they are not those that the directory states.
fn content(bytes: &[u8], entry: &Entry) -> Option<Vec<u8>> {
    let mut input = ByteReader::new(bytes.get(usize::try_from(entry.at).ok()?..)?);
    if input.take(4)? != FILE {
        return None;
    }
    let _until_lengths: [u8; 22] = input.array()?;
    let lengths = [number::<2>(&mut input)?, number::<2>(&mut input)?];
    let _name_and_fields = input.take(lengths.iter().sum::<u64>() as usize)?;
    let packed = input.take(usize::try_from(entry.packed).ok()?)?;
    let content = match entry.method {
        0 => packed.to_vec(),
        8 => {
            let mut all = Vec::new();
            let stream = flate2::read::DeflateDecoder::new(packed);
            stream.take(entry.size + 1).read_to_end(&mut all).ok()?;
            all
        }
        _ => return None,
    };
    let is_whole = content.len() as u64 == entry.size && crc32fast::hash(&content) == entry.crc;
    is_whole.then_some(content)
}
