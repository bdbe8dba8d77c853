//! Reads and writes pictures as PNG and JPEG files.

use std::io::Cursor;
use std::path::Path;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::jpeg_scan;
use super::picture::{Grey, Picture, check_size};
use realgap_core::error::{Error, Result};
use realgap_core::file::{png_bytes, read_limited, write_atomic};

/// Largest file that is read, bytes: the size of 32 megapixels of 16-bit colour with transparency without compression.
const MOST_BYTES: u64 = 260_000_000;
const PNG_START: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG_START: &[u8] = b"\xff\xd8\xff";

impl Picture {
    /// Reads a PNG or JPEG file; the format is detected from the content. Of 16 bits per channel, the upper eight are kept; transparent
    /// pixels are blended with white.
    ///
    /// # Errors
    /// A missing file, a file that is not a picture, damaged pictures, more than 32 megapixels.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::decode(&bytes_of(path)?).map_err(|e| e.at_file(path))
    }

    /// Decodes the bytes of a PNG or JPEG file.
    ///
    /// # Errors
    /// The errors of [`Picture::read`].
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        if bytes.starts_with(PNG_START) {
            decode_png(bytes)
        } else if bytes.starts_with(JPEG_START) {
            decode_jpeg(bytes)
        } else {
            Err(no_picture(bytes))
        }
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// None for a picture that exists.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        png_bytes(self.width() as u32, self.height() as u32, self.rgb())
    }

    /// The bytes of a JPEG file of this quality, 1 to 100.
    ///
    /// # Errors
    /// A side above 65535 pixels.
    pub fn to_jpeg(&self, quality: u8) -> Result<Vec<u8>> {
        let side = |pixels: usize| {
            u16::try_from(pixels).map_err(|_| {
                Error::invalid("too large for a JPEG file")
                    .found(format!("{pixels} pixels"))
                    .allowed("sides of at most 65535 pixels")
            })
        };
        let mut bytes = Vec::new();
        jpeg_encoder::Encoder::new(&mut bytes, quality.clamp(1, 100))
            .encode(
                self.rgb(),
                side(self.width())?,
                side(self.height())?,
                jpeg_encoder::ColorType::Rgb,
            )
            .map_err(|e| Error::invalid(format!("cannot encode the picture as JPEG: {e}")))?;
        Ok(bytes)
    }

    /// Writes a PNG file, whatever the ending of its name.
    ///
    /// # Errors
    /// A missing folder, a full disk.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        write_atomic(path, &self.to_png()?)
    }
}

impl Grey {
    /// Reads a picture and converts it to grey values: [`Picture::read`] and [`Picture::grey`].
    ///
    /// # Errors
    /// The errors of [`Picture::read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Picture::read(path).map(|picture| picture.grey())
    }
}

/// Width and height of a picture; only its header is decoded.
///
/// # Errors
/// The errors of [`Picture::read`] that the header shows.
pub(super) fn size_of(path: &Path) -> Result<(usize, usize)> {
    let bytes = bytes_of(path)?;
    let size = if bytes.starts_with(PNG_START) {
        png_header(&bytes)
            .map(|reader| (reader.info().width as usize, reader.info().height as usize))
    } else if bytes.starts_with(JPEG_START) {
        jpeg_header(&bytes).map(|(_, width, height)| (width, height))
    } else {
        Err(no_picture(&bytes))
    };
    size.map_err(|e| e.at_file(path))
}

fn bytes_of(path: &Path) -> Result<Vec<u8>> {
    let bytes = read_limited(path, MOST_BYTES, "picture")?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(
            Error::invalid("cannot read the picture: the file is too large")
                .at_file(path)
                .allowed(format!("at most {MOST_BYTES} bytes")),
        );
    }
    Ok(bytes)
}

fn no_picture(bytes: &[u8]) -> Error {
    let start: Vec<String> = bytes.iter().take(4).map(|b| format!("{b:02x}")).collect();
    Error::invalid("not a picture")
        .found(if start.is_empty() {
            "an empty file".to_owned()
        } else {
            format!("a file that starts with {}", start.join(" "))
        })
        .allowed("PNG and JPEG")
        .hint("convert other formats, e.g. to PNG")
}

fn broken(error: impl std::fmt::Display) -> Error {
    Error::invalid("the picture cannot be decoded").found(error)
}

/// Reads the header of a PNG file and refuses a picture that is too large before it is decoded.
fn png_header(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>> {
    let limits = png::Limits {
        bytes: MOST_BYTES as usize,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let reader = decoder.read_info().map_err(broken)?;
    check_size(reader.info().width as usize, reader.info().height as usize)?;
    Ok(reader)
}

/// Rows are converted one by one, so that a large picture is in memory once.
fn decode_png(bytes: &[u8]) -> Result<Picture> {
    let mut reader = png_header(bytes)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let (color, _) = reader.output_color_type();
    let mut rgb = Vec::with_capacity(3 * width * height);
    if reader.info().interlaced {
        let size = reader
            .output_buffer_size()
            .ok_or_else(|| broken("its size overflows"))?;
        let mut pixels = vec![0; size];
        let frame = reader.next_frame(&mut pixels).map_err(broken)?;
        push_rgb(&mut rgb, &pixels[..frame.buffer_size()], color);
    } else {
        while let Some(row) = reader.next_row().map_err(broken)? {
            push_rgb(&mut rgb, row.data(), color);
        }
    }
    // The file is read to its end, because a file that is cut off may lack pixels, too.
    reader.finish().map_err(broken)?;
    Picture::new(width, height, rgb)
}

/// Adds pixels with 8 bits for each channel.
fn push_rgb(rgb: &mut Vec<u8>, pixels: &[u8], color: png::ColorType) {
    let over_white = |value: u8, alpha: u8| {
        let (value, alpha) = (u32::from(value), u32::from(alpha));
        ((value * alpha + 255 * (255 - alpha) + 127) / 255) as u8
    };
    match color {
        png::ColorType::Rgb | png::ColorType::Indexed => rgb.extend_from_slice(pixels),
        png::ColorType::Grayscale => {
            for value in pixels {
                rgb.extend_from_slice(&[*value; 3]);
            }
        }
        png::ColorType::GrayscaleAlpha => {
            for pixel in pixels.chunks_exact(2) {
                rgb.extend_from_slice(&[over_white(pixel[0], pixel[1]); 3]);
            }
        }
        png::ColorType::Rgba => {
            for pixel in pixels.chunks_exact(4) {
                let over = [pixel[0], pixel[1], pixel[2]].map(|v| over_white(v, pixel[3]));
                rgb.extend_from_slice(&over);
            }
        }
    }
}

type Jpeg<'a> = JpegDecoder<ZCursor<&'a [u8]>>;

/// Reads the header of a JPEG file, as [`png_header`] does for PNG; also returns width and height.
fn jpeg_header(bytes: &[u8]) -> Result<(Jpeg<'_>, usize, usize)> {
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(65_535)
        .set_max_height(65_535);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(broken)?;
    let (width, height) = decoder
        .dimensions()
        .ok_or_else(|| broken("it has no size"))?;
    check_size(width, height)?;
    Ok((decoder, width, height))
}

fn decode_jpeg(bytes: &[u8]) -> Result<Picture> {
    let (mut decoder, width, height) = jpeg_header(bytes)?;
    if let Some(found) = jpeg_scan::fault(bytes) {
        return Err(broken(found).hint("copy the picture again from its source"));
    }
    let pixels = decoder.decode().map_err(broken)?;
    let rgb = match decoder.output_colorspace() {
        Some(ColorSpace::Luma) => pixels.iter().flat_map(|v| [*v; 3]).collect(),
        _ => pixels,
    };
    Picture::new(width, height, rgb)
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution as _, Uniform};
    use realgap_core::random::Once;

    use super::Picture;

    /// Seed of the noise and of the positions at which files are cut.
    const SEED: u64 = 30;

    #[test]
    fn a_picture_file_that_is_cut_off_anywhere_is_refused() {
        let mut rng = Once::Subset.generator(SEED);
        let noise = Uniform::new_inclusive(0, u8::MAX).unwrap();
        let rgb = (0..3 * 67 * 45).map(|_| noise.sample(&mut rng)).collect();
        let picture = Picture::new(67, 45, rgb).unwrap();
        let (png, jpeg) = (picture.to_png().unwrap(), picture.to_jpeg(90).unwrap());
        for bytes in [&png, &jpeg] {
            Picture::decode(bytes).unwrap();
            let place = Uniform::new(0, bytes.len()).unwrap();
            let cuts = (0..200).map(|_| place.sample(&mut rng));
            for length in cuts.chain(bytes.len() - 20..bytes.len()) {
                assert!(Picture::decode(&bytes[..length]).is_err(), "{length}");
            }
        }
    }
}
