//! Encodes pixels as a PNG file or as an animated PNG file.

use crate::error::{Error, Result};

fn unexpected(error: png::EncodingError) -> Error {
    Error::invalid(format!("cannot encode the picture as PNG: {error}"))
}

/// An encoder for pictures with 8 bits per channel that name realgap as their software.
fn encoder(
    bytes: &mut Vec<u8>,
    [width, height]: [u32; 2],
    colour: png::ColorType,
) -> Result<png::Encoder<'_, &mut Vec<u8>>> {
    let mut encoder = png::Encoder::new(bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder
        .add_text_chunk("Software".to_owned(), "realgap".to_owned())
        .map_err(unexpected)?;
    Ok(encoder)
}

/// The bytes of a PNG file with 8 bits per channel; `rgb` holds three bytes per pixel, row by row.
///
/// # Errors
/// Sizes that do not fit the pixels.
pub fn png_bytes(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = encoder(&mut bytes, [width, height], png::ColorType::Rgb)?;
    let mut writer = encoder.write_header().map_err(unexpected)?;
    writer.write_image_data(rgb).map_err(unexpected)?;
    writer.finish().map_err(unexpected)?;
    Ok(bytes)
}

/// An animated PNG file that is written picture by picture, with 8 bits per channel. Each picture stores only the pixels that differ from
/// the previous picture; the other pixels are transparent, which takes very few bytes.
pub struct AnimatedPng<'f> {
    writer: png::Writer<&'f mut Vec<u8>>,
    size: [usize; 2],
    previous: Option<Vec<u8>>,
}

/// Left edge, top edge, width and height of a rectangle, pixels.
type Area = [usize; 4];

impl<'f> AnimatedPng<'f> {
    /// Starts a file in `bytes` with this number of pictures; each is shown for `shown_s` seconds, in an endless loop.
    ///
    /// # Errors
    /// No pictures, or a width or height of 0.
    pub fn new(
        bytes: &'f mut Vec<u8>,
        size: [u32; 2],
        pictures: usize,
        shown_s: f64,
    ) -> Result<Self> {
        let mut encoder = encoder(bytes, size, png::ColorType::Rgba)?;
        encoder
            .set_animated(u32::try_from(pictures).unwrap_or(u32::MAX), 0)
            .map_err(unexpected)?;
        let shown_ms = (1000.0 * shown_s).round().clamp(10.0, 60_000.0) as u16;
        encoder
            .set_frame_delay(shown_ms, 1000)
            .map_err(unexpected)?;
        Ok(Self {
            writer: encoder.write_header().map_err(unexpected)?,
            size: size.map(|side| side as usize),
            previous: None,
        })
    }

    /// Adds a picture: three bytes per pixel, row by row.
    ///
    /// # Errors
    /// More pictures than [`AnimatedPng::new`] was given, or a number of pixels that does not fit the size.
    pub fn push(&mut self, rgb: Vec<u8>) -> Result<()> {
        let [width, height] = self.size;
        let area = match &self.previous {
            Some(previous) if previous.len() == rgb.len() => changed(previous, &rgb, width),
            _ => [0, 0, width, height],
        };
        let [left, top, wide, tall] = area;
        if self.previous.is_some() {
            let writer = &mut self.writer;
            writer
                .set_blend_op(png::BlendOp::Over)
                .map_err(unexpected)?;
            writer.reset_frame_position().map_err(unexpected)?;
            let size = [wide, tall].map(|pixels| pixels as u32);
            writer
                .set_frame_dimension(size[0], size[1])
                .map_err(unexpected)?;
            let place = [left, top].map(|pixels| pixels as u32);
            writer
                .set_frame_position(place[0], place[1])
                .map_err(unexpected)?;
        }
        let same = |at: usize| match &self.previous {
            Some(previous) => previous[at..at + 3] == rgb[at..at + 3],
            None => false,
        };
        let mut part = Vec::with_capacity(4 * wide * tall);
        for y in top..top + tall {
            for x in left..left + wide {
                let at = 3 * (y * width + x);
                if same(at) {
                    part.extend([0; 4]);
                } else {
                    part.extend(&rgb[at..at + 3]);
                    part.push(u8::MAX);
                }
            }
        }
        self.writer.write_image_data(&part).map_err(unexpected)?;
        self.previous = Some(rgb);
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Fewer pictures than [`AnimatedPng::new`] was given.
    pub fn finish(self) -> Result<()> {
        self.writer.finish().map_err(unexpected)
    }
}

/// The smallest rectangle that contains all differences of two pictures of this width; one pixel if the pictures are equal.
fn changed(a: &[u8], b: &[u8], width: usize) -> Area {
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    let rows = a.chunks_exact(3 * width).zip(b.chunks_exact(3 * width));
    for (y, (a, b)) in rows.enumerate() {
        let differs = |x: &usize| a[3 * x..3 * x + 3] != b[3 * x..3 * x + 3];
        let Some(first) = (0..width).find(differs) else {
            continue;
        };
        let last = (0..width).rev().find(differs).unwrap_or(first);
        low = [low[0].min(first), low[1].min(y)];
        high = [high[0].max(last), y];
    }
    if low[0] == usize::MAX {
        return [0, 0, 1, 1];
    }
    [low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1]
}
