//! Renderers of pictures: PNG and SVG files (by the extension of the path, complete or not there at all), and SVG inside of
//! a page ([`inline`]).

pub(crate) mod inline;

use std::path::Path;

use realgap_drawing::Canvas;

use super::layout::font;
use realgap_core::file::{check_writable, png_bytes, write_atomic};
use realgap_core::{Error, Result};

/// A picture as plain data, which draws itself on a canvas.
pub(crate) trait Picture {
    /// Refuses data that do not fit together, or of which there is nothing to draw.
    fn check(&self) -> Result<()> {
        Ok(())
    }
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);
    /// Draws on a white canvas of that size.
    fn draw(&self, canvas: &mut Canvas);
}

/// The format of a picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Png,
    Svg,
}

/// The format that the extension of a file names.
fn format_of(path: &Path) -> Result<Format> {
    let extension = path.extension();
    let extension = extension.map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(Format::Png),
        Some("svg") => Ok(Format::Svg),
        other => Err(Error::usage("a picture can only be written as PNG or SVG")
            .at_file(path)
            .found(other.map_or("no extension".to_string(), |e| format!(".{e}")))
            .allowed(".png, .svg")),
    }
}

/// Checks that a picture could be written under this name, before the work for it is done.
pub fn check_picture_path(path: impl AsRef<Path>) -> Result<()> {
    format_of(path.as_ref())?;
    check_writable(path)
}

/// The largest number of pictures side by side: more would be narrower than their titles.
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
#[cfg(feature = "papers")]
pub(crate) fn both(folder: &Path, stem: &str, draw: impl Fn(&Path) -> Result<()>) -> Result<()> {
    draw(&folder.join(format!("{stem}.png")))?;
    draw(&folder.join(format!("{stem}.svg")))
}

/// Draws `picture` and writes it.
pub(in crate::plot) fn write(picture: &impl Picture, path: &Path) -> Result<()> {
    write_atomic(path, &file_bytes(picture, format_of(path)?)?)
}

/// The bytes of a picture file.
pub(crate) fn file_bytes(picture: &impl Picture, format: Format) -> Result<Vec<u8>> {
    picture.check()?;
    font::check()?;
    if format == Format::Png {
        let (width, height) = picture.size();
        return png_bytes(width, height, &pixels(picture)?);
    }
    let mut bytes = realgap_drawing::svg(&drawn(picture), picture.size())?;
    // A comment behind the first tag says that this program wrote the file, so that a later run may replace it.
    if let Some(end) = bytes.iter().position(|byte| *byte == b'>') {
        let mark = *b"<!-- Written by realgap -->";
        bytes.splice(end + 1..end + 1, mark);
    }
    Ok(bytes)
}

/// The canvas with the picture on it.
fn drawn(picture: &impl Picture) -> Canvas {
    let mut canvas = Canvas::default();
    picture.draw(&mut canvas);
    canvas
}

/// The pixels of a picture, three bytes each, row by row.
pub(in crate::plot) fn pixels(picture: &impl Picture) -> Result<Vec<u8>> {
    realgap_drawing::pixels(&drawn(picture), picture.size())
}
