//! From a picture to a file: PNG or SVG by extension, complete or not there at all.

use std::path::Path;

use realgap_drawing::Canvas;

use super::layout::font;
use realgap_core::file::{check_writable, png_bytes, write_atomic};
use realgap_core::{Error, Result};

/// Something that can be drawn.
pub(in crate::plot) trait Picture {
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);
    /// Draws on a white canvas of that size.
    fn draw(&self, canvas: &mut Canvas);
}

/// Whether a picture of this name is an SVG; a PNG otherwise.
fn is_svg(path: &Path) -> Result<bool> {
    let extension = path.extension();
    let extension = extension.map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(false),
        Some("svg") => Ok(true),
        other => Err(Error::usage("a picture can only be written as PNG or SVG")
            .at_file(path)
            .found(other.map_or("no extension".to_string(), |e| format!(".{e}")))
            .allowed(".png, .svg")),
    }
}

/// Checks that a picture could be written under this name, before the work for it is done.
pub fn check_picture_path(path: impl AsRef<Path>) -> Result<()> {
    is_svg(path.as_ref())?;
    check_writable(path)
}

/// More pictures side by side would be smaller than their titles.
const COLUMNS_AT_MOST: usize = 6;
const CELLS_AT_MOST: usize = 60;

/// Checks the number of small pictures, filled row by row, and how many of them stand side by side.
pub(in crate::plot) fn check_rows(field: &str, count: usize, columns: usize) -> Result<()> {
    for (field, found, most) in [
        (field, count, CELLS_AT_MOST),
        ("columns", columns, COLUMNS_AT_MOST),
    ] {
        if !(1..=most).contains(&found) {
            return Err(Error::invalid("wrong number of pictures in one")
                .field(field)
                .found(found)
                .allowed(format!("1 to {most}")));
        }
    }
    Ok(())
}

/// Lets `draw` write `STEM.png` and `STEM.svg` of the folder.
pub(crate) fn both(folder: &Path, stem: &str, draw: impl Fn(&Path) -> Result<()>) -> Result<()> {
    draw(&folder.join(format!("{stem}.png")))?;
    draw(&folder.join(format!("{stem}.svg")))
}

/// Draws `picture` and writes it.
pub(in crate::plot) fn write(picture: &impl Picture, path: &Path) -> Result<()> {
    let is_svg = is_svg(path)?;
    font::check()?;
    if !is_svg {
        let (width, height) = picture.size();
        return write_atomic(path, &png_bytes(width, height, &pixels(picture)?)?);
    }
    let mut bytes = realgap_drawing::svg(&drawn(picture), picture.size())?;
    // Conclusion, behind its first tag, who wrote it, so that it may be written again.
    if let Some(end) = bytes.iter().position(|byte| *byte == b'>') {
        let mark = *b"<!-- Written by realgap -->";
        bytes.splice(end + 1..end + 1, mark);
    }
    write_atomic(path, &bytes)
}

/// What is drawn of a picture.
fn drawn(picture: &impl Picture) -> Canvas {
    let mut canvas = Canvas::default();
    picture.draw(&mut canvas);
    canvas
}

/// The pixels of a picture, three bytes each, row by row.
pub(in crate::plot) fn pixels(picture: &impl Picture) -> Result<Vec<u8>> {
    realgap_drawing::pixels(&drawn(picture), picture.size())
}
