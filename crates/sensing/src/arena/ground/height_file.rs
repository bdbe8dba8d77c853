//! Reads height fields from CSV matrices and grey PNG pictures.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::HeightField;
use realgap_core::error::{Error, Result};
use realgap_core::file::{read_regular, sha256};

/// The largest file of heights, bytes.
const MOST_BYTES: u64 = 64_000_000;

/// What the ground is, as an arena's file states it.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Ground")]
pub enum GroundFile {
    /// The flat floor.
    #[default]
    Flat,
    /// A height field in place of a part of the floor, which stays flat around it. Seen from above, rows of the file go along x,
    /// and its first row has the largest y.
    HeightField {
        /// A matrix of heights in metres (`.csv`; commas, semicolons or blanks between numbers), or a grey picture with 8 or 16
        /// bits (`.png`), relative to this file.
        file: PathBuf,
        /// Corner with the smallest x and y, metres.
        from_m: [f64; 2],
        /// Width along x and depth along y, metres: the first and last points of rows and columns are on its rim.
        size_m: [f64; 2],
        /// Heights of black and of white in a picture, metres above the floor; only for a picture.
        #[serde(default)]
        height_m: Option<(f64, f64)>,
    },
}

impl GroundFile {
    /// The height field, if there is one, from a file relative to this folder.
    ///
    /// # Errors
    /// A file that is missing, too large, or not heights; numbers out of range.
    pub fn read(&self, folder: &Path) -> Result<Option<Arc<HeightField>>> {
        let Self::HeightField {
            file,
            from_m,
            size_m,
            height_m,
        } = self
        else {
            return Ok(None);
        };
        if !from_m
            .iter()
            .all(|value| value.is_finite() && value.abs() <= 1e4)
        {
            return Err(Error::invalid("not a place of a height field")
                .field("from_m")
                .found(format!("{from_m:?} m"))
                .allowed("finite numbers, at most 10 km from the origin"));
        }
        let path = folder.join(file);
        let bytes = read_regular(&path, MOST_BYTES, "height field")?;
        let kind = path.extension().map(|kind| kind.to_ascii_lowercase());
        let rows = match kind.as_deref().and_then(|kind| kind.to_str()) {
            Some("csv") => {
                if let Some(range) = height_m {
                    return Err(Error::invalid("the heights of a CSV are metres already")
                        .field("height_m")
                        .found(format!("{range:?}"))
                        .allowed("none beside a .csv")
                        .hint(
                            "leave `height_m` out; `floor.heights_scale` makes all heights larger",
                        ));
                }
                matrix(&bytes)
            }
            Some("png") => {
                let Some(range) = height_m else {
                    return Err(
                        Error::invalid("a picture does not say how high its ground is")
                            .field("height_m")
                            .found("nothing")
                            .allowed("the heights of black and of white, metres")
                            .hint("add e.g. height_m: (0.0, 0.05)"),
                    );
                };
                picture(&bytes, *range)
            }
            _ => Err(Error::invalid("not a kind of file for a height field")
                .found(file.display())
                .allowed("a matrix of metres (.csv) or a grey picture (.png)")),
        }
        .map_err(|e| e.at_file(&path))?;
        let mut field = HeightField::new(&rows, *size_m).map_err(|e| match e.field_name() {
            Some(_) => e,
            None => e.at_file(&path),
        })?;
        field.file = file.display().to_string();
        field.sha256 = sha256(&bytes);
        field.centre_m = [from_m[0] + 0.5 * size_m[0], from_m[1] + 0.5 * size_m[1]];
        Ok(Some(Arc::new(field)))
    }
}

/// A matrix of numbers: a line for each row.
fn matrix(bytes: &[u8]) -> Result<Vec<Vec<f64>>> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| Error::invalid("not a text").found(error).allowed("UTF-8"))?;
    let text = text.trim_start_matches('\u{feff}');
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let cells: Vec<&str> = match line.contains([',', ';']) {
            true => line.split([',', ';']).map(str::trim).collect(),
            false => line.split_whitespace().collect(),
        };
        let mut row = Vec::with_capacity(cells.len());
        for (column, cell) in cells.into_iter().enumerate() {
            let value: f64 = cell.parse().map_err(|_| {
                Error::invalid("not a height")
                    .at_line(index + 1, 1)
                    .found(format!("{cell:?} in column {}", column + 1))
                    .allowed("a number of metres in every cell, without a header")
            })?;
            if !value.is_finite() {
                return Err(Error::invalid("not a height")
                    .at_line(index + 1, 1)
                    .found(format!("{value} in column {}", column + 1))
                    .allowed("finite numbers of metres"));
            }
            row.push(value);
        }
        rows.push(row);
        if rows.len() > HeightField::COUNTS.1 {
            break;
        }
    }
    Ok(rows)
}

fn broken(error: impl std::fmt::Display) -> Error {
    Error::invalid("the picture cannot be decoded").found(error)
}

/// The heights of a grey picture.
fn picture(bytes: &[u8], (black_m, white_m): (f64, f64)) -> Result<Vec<Vec<f64>>> {
    let limits = png::Limits {
        bytes: MOST_BYTES as usize,
    };
    let mut reader = png::Decoder::new_with_limits(Cursor::new(bytes), limits)
        .read_info()
        .map_err(broken)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let (few, many) = HeightField::COUNTS;
    if ![width, height]
        .iter()
        .all(|count| (few..=many).contains(count))
    {
        return Err(Error::invalid("not a size of a picture of heights")
            .found(format!("{width} x {height} pixels"))
            .allowed(format!("{few} to {many} pixels along both sides")));
    }
    let (colour, depth) = reader.output_color_type();
    let wide = match (colour, depth) {
        (png::ColorType::Grayscale, png::BitDepth::Eight) => 1,
        (png::ColorType::Grayscale, png::BitDepth::Sixteen) => 2,
        other => {
            return Err(Error::invalid("not a grey picture")
                .found(format!("{:?} with {:?} bits", other.0, other.1))
                .allowed("grey with 8 or 16 bits, without transparency")
                .hint("convert it, e.g. with ImageMagick: -colorspace Gray -alpha off -depth 16"));
        }
    };
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| broken("its size overflows"))?;
    let mut pixels = vec![0; size];
    let frame = reader.next_frame(&mut pixels).map_err(broken)?;
    // The file is read to its end, because a file that is cut off may lack pixels, too.
    reader.finish().map_err(broken)?;
    let share = |pixel: &[u8]| match pixel {
        [one] => f64::from(*one) / 255.0,
        [high, low] => f64::from(u16::from_be_bytes([*high, *low])) / 65535.0,
        _ => 0.0,
    };
    let row = |line: &[u8]| -> Vec<f64> {
        let shares = line.chunks_exact(wide).map(share);
        shares.map(|s| black_m + s * (white_m - black_m)).collect()
    };
    Ok(pixels[..frame.buffer_size()]
        .chunks_exact(width * wide)
        .map(row)
        .collect())
}
