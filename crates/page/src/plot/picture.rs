//! From a picture to a file: PNG or SVG by extension, complete or not there at all.

use std::path::Path;

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};

use super::canvas::{Canvas, Medium};
use super::colour::WHITE;
use super::font;
use realgap_core::file::{check_writable, png_bytes, write_atomic};
use realgap_core::{Error, Result};

/// PNG pixels are averages of this many by this many: smooth lines, evenly spaced letters.
const PNG_OVERSAMPLING: u32 = 3;
/// SVG coordinates of plotters are whole numbers; this many to a unit.
const SVG_PER_UNIT: u32 = 10;

/// Something that can be drawn on any plotters backend.
pub(super) trait Picture {
    /// Width and height in pixels.
    fn size(&self) -> (u32, u32);
    /// Draws on a white canvas of that size.
    fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<B>);
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Svg,
}

fn format_of(path: &Path) -> Result<Format> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
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

/// More pictures side by side would be smaller than their titles.
const COLUMNS_AT_MOST: usize = 6;
const CELLS_AT_MOST: usize = 60;

/// Checks the number of small pictures, filled row by row, and how many of them stand side by side.
pub(super) fn check_rows(field: &str, count: usize, columns: usize) -> Result<()> {
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
pub(super) fn write(picture: &impl Picture, path: &Path) -> Result<()> {
    let format = format_of(path)?;
    font::check()?;
    let bytes = match format {
        Format::Png => png(picture)?,
        Format::Svg => svg(picture)?,
    };
    write_atomic(path, &bytes)
}

fn png(picture: &impl Picture) -> Result<Vec<u8>> {
    let (width, height) = picture.size();
    png_bytes(width, height, &pixels(picture)?)
}

/// The pixels of a picture, three bytes each, row by row.
pub(super) fn pixels(picture: &impl Picture) -> Result<Vec<u8>> {
    let (width, height) = picture.size();
    let large = (width * PNG_OVERSAMPLING, height * PNG_OVERSAMPLING);
    let mut pixels = vec![255; large.0 as usize * large.1 as usize * 3];
    let backend = BitMapBackend::with_buffer(&mut pixels, large);
    let mut canvas = Canvas::new(backend, Medium::Pixels, PNG_OVERSAMPLING);
    picture.draw(&mut canvas);
    canvas.finish()?;
    Ok(average(&pixels, width as usize, height as usize))
}

/// The mean of each block of `PNG_OVERSAMPLING` × `PNG_OVERSAMPLING` pixels.
fn average(large: &[u8], width: usize, height: usize) -> Vec<u8> {
    let factor = PNG_OVERSAMPLING as usize;
    let row_bytes = width * factor * 3;
    let mut small = Vec::with_capacity(width * height * 3);
    let mut sums = vec![0u16; width * 3];
    for block in large.chunks_exact(row_bytes * factor) {
        sums.fill(0);
        for row in block.chunks_exact(row_bytes) {
            for (sum, pixels) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * factor)) {
                for pixel in pixels.chunks_exact(3) {
                    for (sum, channel) in sum.iter_mut().zip(pixel) {
                        *sum += u16::from(*channel);
                    }
                }
            }
        }
        let count = (factor * factor) as u16;
        small.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    small
}

fn svg(picture: &impl Picture) -> Result<Vec<u8>> {
    let (width, height) = picture.size();
    let large = (width * SVG_PER_UNIT, height * SVG_PER_UNIT);
    let mut text = String::new();
    let backend = SVGBackend::with_string(&mut text, large);
    let mut canvas = Canvas::new(backend, Medium::Vector, SVG_PER_UNIT);
    canvas.fill((0.0, 0.0), (f64::from(width), f64::from(height)), WHITE);
    picture.draw(&mut canvas);
    canvas.finish()?;
    // plotters writes the fine coordinates as the size; the view box alone should have them.
    let fine = format!("width=\"{}\" height=\"{}\"", large.0, large.1);
    let real = format!(
        "width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\" stroke-linecap=\"round\""
    );
    Ok(text.replacen(&fine, &real, 1).into_bytes())
}
