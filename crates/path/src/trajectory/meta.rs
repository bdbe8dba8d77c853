//! Reads and writes the metadata file `meta.ron` beside recordings.

use std::path::Path;

use super::Meta;
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, parse_ron, write_atomic, write_ron};

/// Name of the metadata file of a folder of recordings.
pub const META_FILE: &str = "meta.ron";

/// The metadata in the folder of `path`, if there is any.
///
/// # Errors
/// A `meta.ron` that cannot be read or is not valid [`Meta`], with file, line and column.
pub fn read_meta_beside(path: &Path) -> Result<Option<Meta>> {
    let meta = path.with_file_name(META_FILE);
    // A dangling symbolic link counts as present, so that its error is reported.
    match std::fs::symlink_metadata(&meta) {
        Err(_) => Ok(None),
        Ok(_) if meta.exists() && !meta.is_file() => Err(Error::invalid("metadata must be a file")
            .at_file(&meta)
            .found("a folder, a pipe or a device")),
        Ok(_) => read_meta(meta).map(Some),
    }
}

/// Reads a `meta.ron`.
///
/// # Errors
/// A file that cannot be read or is not valid [`Meta`], with file, line and column.
pub fn read_meta(path: impl AsRef<Path>) -> Result<Meta> {
    parse_ron(&Source::read(path, "metadata")?)
}

/// Writes the `meta.ron` of a folder of recordings.
///
/// # Errors
/// An unwritable folder or a full disk.
pub fn write_meta(folder: &Path, meta: &Meta) -> Result<()> {
    write_atomic(folder.join(META_FILE), write_ron(meta)?.as_bytes())
}
