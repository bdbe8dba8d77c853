//! The `meta.ron` beside recordings.

use std::path::Path;

use super::Meta;
use super::text::read_text;
use crate::error::{Error, Result};

/// Name of the metadata file of a folder of recordings.
pub const META_FILE: &str = "meta.ron";

const MAX_META_BYTES: u64 = 1_000_000;

/// The metadata in the folder of `path`, if there is any.
///
/// # Errors
/// A `meta.ron` that cannot be read or is not valid [`Meta`], with file, line and column.
pub fn read_meta_beside(path: &Path) -> Result<Option<Meta>> {
    let meta = path.with_file_name(META_FILE);
    if !meta.is_file() {
        return Ok(None);
    }
    let text = read_text(&meta, MAX_META_BYTES, "metadata")?;
    ron::from_str(&text).map(Some).map_err(|error| {
        let start = error.span.start;
        Error::invalid(error.code.to_string())
            .at_file(&meta)
            .at_line(start.line, start.col)
            .allowed("(robot: \"...\", source: Real or StandIn, description: \"...\", frame: \"...\", licence: \"...\")")
    })
}
