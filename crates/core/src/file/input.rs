//! Reads the bytes of a file safely: the path may be missing, be a folder, or be an endless device.

use std::io::Read as _;
use std::path::Path;

use super::seal::check_sealed;
use crate::error::{Error, Result};

/// At most `limit` + 1 bytes of the file at `path`: a longer file, also an endless one such as /dev/zero, is then refused by
/// the caller's check of the size. `kind` is the name of such a file in error messages, e.g. "morphology".
///
/// # Errors
/// Missing or unreadable files, and folders; a file of a results folder whose content differs from its checksum.
pub fn read_limited(path: &Path, limit: u64, kind: &str) -> Result<Vec<u8>> {
    let doing = format!("read the {kind}");
    let refuse = |error: std::io::Error| Error::io(&doing, path, &error);
    let file = std::fs::File::open(path).map_err(refuse)?;
    if file.metadata().map_err(refuse)?.is_dir() {
        return Err(Error::invalid(format!("cannot {doing}: this is a folder"))
            .at_file(path)
            .hint("name one file inside it"));
    }
    let mut bytes = Vec::new();
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(refuse)?;
    if bytes.len() as u64 <= limit {
        check_sealed(path, &bytes)?;
    }
    Ok(bytes)
}
