//! Pixels as the bytes of a PNG file.

use crate::error::{Error, Result};

/// The bytes of a PNG file with 8 bits a channel; `rgb` holds three bytes a pixel, row by row.
///
/// # Errors
/// Sizes that do not fit the pixels.
pub(crate) fn png_bytes(width: u32, height: u32, rgb: &[u8]) -> Result<Vec<u8>> {
    let unexpected = |error: png::EncodingError| {
        Error::invalid(format!("cannot encode the picture as PNG: {error}"))
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header().map_err(unexpected)?;
    writer.write_image_data(rgb).map_err(unexpected)?;
    writer.finish().map_err(unexpected)?;
    Ok(bytes)
}
