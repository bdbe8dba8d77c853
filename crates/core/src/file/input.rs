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

/// The bytes of a file that another file names, e.g. a mesh: only a regular file of at most `limit` bytes is read, so that a name such
/// as /dev/zero or a pipe neither fills the memory nor waits for ever. `kind` is the name of such a file in error messages.
///
/// # Errors
/// Missing or unreadable files; anything that is not a regular file; a file that is too large, also one that grows meanwhile.
pub fn read_regular(path: &Path, limit: u64, kind: &str) -> Result<Vec<u8>> {
    let doing = format!("read the {kind}");
    let metadata = std::fs::metadata(path).map_err(|e| Error::io(&doing, path, &e))?;
    if !metadata.is_file() {
        let found = if metadata.is_dir() {
            "a folder"
        } else {
            "a device, a pipe or a socket"
        };
        return Err(
            Error::invalid(format!("cannot {doing}: this is no regular file"))
                .at_file(path)
                .found(found)
                .allowed("a regular file")
                .hint("copy what is needed into a file"),
        );
    }
    let too_large = |bytes: String| {
        Error::invalid(format!("cannot {doing}: the file is too large"))
            .at_file(path)
            .found(bytes)
            .allowed(format!("at most {limit} bytes"))
    };
    if metadata.len() > limit {
        return Err(too_large(format!("{} bytes", metadata.len())));
    }
    let bytes = read_limited(path, limit, kind)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(format!("more than {limit} bytes")));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::read_regular;

    #[test]
    fn only_regular_files_below_the_limit_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mesh.stl");
        std::fs::write(&file, "12345").unwrap();
        assert_eq!(read_regular(&file, 5, "mesh").unwrap(), b"12345");
        let error = read_regular(&file, 4, "mesh").unwrap_err().to_string();
        assert!(
            error.contains("5 bytes") && error.contains("at most 4"),
            "{error}"
        );
        let error = read_regular(folder.path(), 4, "mesh").unwrap_err();
        assert!(error.to_string().contains("a folder"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn endless_devices_are_refused_before_a_byte_is_read() {
        let error = read_regular("/dev/zero".as_ref(), 1 << 40, "mesh").unwrap_err();
        assert!(error.to_string().contains("no regular file"), "{error}");
    }
}
