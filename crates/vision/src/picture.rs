//! The types of pictures: colour pictures of bytes and grey pictures of numbers.

use realgap_core::error::{Error, Result};

/// Largest number of pixels of a picture.
pub const MOST_PIXELS: usize = 32_000_000;

/// A colour picture with 8 bits per channel in sRGB, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

/// Grey values, 0 black to 1 white, row by row from the top. Pixel centres have whole coordinates: x to the right, y down.
#[derive(Debug, Clone, PartialEq)]
pub struct Grey {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Left column.
    pub x_px: usize,
    /// Top row.
    pub y_px: usize,
    /// Number of columns.
    pub width_px: usize,
    /// Number of rows.
    pub height_px: usize,
}

/// Refuses a picture without pixels or with too many.
pub(super) fn check_size(width: usize, height: usize) -> Result<()> {
    let pixels = width.saturating_mul(height);
    if (1..=MOST_PIXELS).contains(&pixels) {
        return Ok(());
    }
    Err(Error::invalid("not a size of a picture")
        .found(format!("{width} x {height} pixels"))
        .allowed(format!(
            "one pixel to {} megapixels",
            MOST_PIXELS / 1_000_000
        )))
}

impl Picture {
    /// A picture of these bytes.
    ///
    /// # Errors
    /// No pixel, more than [`MOST_PIXELS`], a number of bytes that is not three per pixel.
    pub fn new(width: usize, height: usize, rgb: Vec<u8>) -> Result<Self> {
        check_size(width, height)?;
        if rgb.len() != 3 * width * height {
            return Err(Error::invalid("wrong number of bytes for a picture")
                .found(rgb.len())
                .allowed(3 * width * height));
        }
        Ok(Self { width, height, rgb })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, three for each pixel: red, green, blue.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Grey values: luma of ITU-R BT.709 of the stored values, as in scikit-image's `rgb2gray`.
    pub fn grey(&self) -> Grey {
        let values = self
            .rgb
            .chunks_exact(3)
            .map(|pixel| {
                let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(f64::from);
                ((0.2125 * r + 0.7154 * g + 0.0721 * b) / 255.0) as f32
            })
            .collect();
        Grey {
            width: self.width,
            height: self.height,
            values,
        }
    }
}

impl Grey {
    /// A picture of these values.
    ///
    /// # Errors
    /// No pixel, more than [`MOST_PIXELS`], a number of values that differs from the number of pixels, values that are not finite.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Result<Self> {
        check_size(width, height)?;
        if values.len() != width * height {
            return Err(Error::invalid("wrong number of values for a picture")
                .found(values.len())
                .allowed(width * height));
        }
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(Error::invalid("a grey value is not a finite number")
                .found(value)
                .allowed("finite numbers, 0 black to 1 white"));
        }
        Ok(Self {
            width,
            height,
            values,
        })
    }

    /// A picture of the values of a function at every pixel (x, y).
    pub(super) fn from_fn(
        width: usize,
        height: usize,
        value: impl Fn(usize, usize) -> f32,
    ) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            values.extend((0..width).map(|x| value(x, y)));
        }
        Self {
            width,
            height,
            values,
        }
    }

    /// A picture of rows of equal width, converted to the precision of a pixel; there must be at least one row.
    pub(super) fn from_rows(width: usize, rows: impl ExactSizeIterator<Item = Vec<f64>>) -> Self {
        let mut values = Vec::with_capacity(width * rows.len());
        for row in rows {
            values.extend(row.into_iter().map(|value| value as f32));
        }
        Self {
            width,
            height: values.len() / width,
            values,
        }
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The values, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The value at a pixel; beyond the border, the value of the nearest pixel.
    pub fn at(&self, x: i64, y: i64) -> f32 {
        let column = x.clamp(0, self.width as i64 - 1) as usize;
        let row = y.clamp(0, self.height as i64 - 1) as usize;
        self.values[row * self.width + column]
    }

    /// The value between pixels, by bilinear interpolation.
    pub fn between(&self, x: f64, y: f64) -> f32 {
        let (left, top) = (x.floor(), y.floor());
        let (right_share, low_share) = ((x - left) as f32, (y - top) as f32);
        let (i, j) = (left as i64, top as i64);
        let along = |row: i64| {
            let (a, b) = (self.at(i, row), self.at(i + 1, row));
            a + (b - a) * right_share
        };
        let (upper, lower) = (along(j), along(j + 1));
        upper + (lower - upper) * low_share
    }

    /// The picture with some pixels drawn over it, white on dark parts and black on bright parts.
    pub(super) fn drawn_over(&self, is_drawn: impl Fn(usize, usize) -> bool) -> Self {
        Self::from_fn(self.width, self.height, |x, y| {
            let value = self.values[y * self.width + x];
            if is_drawn(x, y) {
                f32::from(u8::from(value < 0.5))
            } else {
                value
            }
        })
    }

    /// The picture with a function applied to every value.
    pub(super) fn map(&self, value: impl Fn(f32) -> f32) -> Self {
        Self {
            width: self.width,
            height: self.height,
            values: self.values.iter().map(|v| value(*v)).collect(),
        }
    }

    /// The picture with values scaled so that the darkest is 0 and the brightest is 1; all values are 0 if the picture is uniform.
    pub fn stretched(&self) -> Self {
        let (low, high) = self
            .values
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| {
                (low.min(*v), high.max(*v))
            });
        let span = high - low;
        self.map(|v| if span > 0.0 { (v - low) / span } else { 0.0 })
    }

    /// A part of the picture.
    ///
    /// # Errors
    /// The part is empty or reaches beyond the picture.
    pub fn cropped(&self, part: Region) -> Result<Self> {
        let fits = |from: usize, size: usize, whole: usize| {
            size > 0 && from.checked_add(size).is_some_and(|end| end <= whole)
        };
        if !fits(part.x_px, part.width_px, self.width)
            || !fits(part.y_px, part.height_px, self.height)
        {
            return Err(Error::invalid("the region is not inside of the picture")
                .field("region")
                .found(format!(
                    "{} x {} px at ({}, {})",
                    part.width_px, part.height_px, part.x_px, part.y_px
                ))
                .allowed(format!("within {} x {} px", self.width, self.height)));
        }
        Ok(Self::from_fn(part.width_px, part.height_px, |x, y| {
            self.values[(part.y_px + y) * self.width + part.x_px + x]
        }))
    }

    /// The picture in another size: means over the area of each new pixel if it is reduced, bilinear interpolation if it is enlarged.
    pub fn resized(&self, width: usize, height: usize) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let columns = shares(self.width, width);
        let rows = shares(self.height, height);
        let mut narrow: Vec<f32> = Vec::with_capacity(width * self.height);
        for row in self.values.chunks_exact(self.width) {
            let sum = |parts: &Vec<(usize, f32)>| -> f32 {
                parts.iter().map(|(i, share)| row[*i] * share).sum()
            };
            narrow.extend(columns.iter().map(sum));
        }
        Self::from_fn(width, height, |x, y| {
            rows[y]
                .iter()
                .map(|(i, share)| narrow[i * width + x] * share)
                .sum()
        })
    }

    /// The picture rotated about its centre by an angle (x towards y, so clockwise on the screen); `beyond` is the value for pixels from
    /// outside of the picture.
    pub fn turned(&self, angle_rad: f64, beyond: f32) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        let centre = [
            0.5 * (self.width - 1) as f64,
            0.5 * (self.height - 1) as f64,
        ];
        Self::from_fn(self.width, self.height, |x, y| {
            let (dx, dy) = (x as f64 - centre[0], y as f64 - centre[1]);
            let from_x = centre[0] + cos * dx + sin * dy;
            let from_y = centre[1] - sin * dx + cos * dy;
            let is_inside = from_x >= -0.5
                && from_y >= -0.5
                && from_x <= self.width as f64 - 0.5
                && from_y <= self.height as f64 - 0.5;
            if is_inside {
                self.between(from_x, from_y)
            } else {
                beyond
            }
        })
    }

    /// The picture as a colour picture.
    pub fn picture(&self) -> Picture {
        let rgb = self
            .values
            .iter()
            .flat_map(|v| [(v.clamp(0.0, 1.0) * 255.0).round() as u8; 3])
            .collect();
        Picture {
            width: self.width,
            height: self.height,
            rgb,
        }
    }
}

/// For each new pixel, the old pixels from which it is computed with their shares, which sum to 1.
fn shares(old: usize, new: usize) -> Vec<Vec<(usize, f32)>> {
    let step = old as f64 / new as f64;
    (0..new)
        .map(|index| {
            if step <= 1.0 {
                let place = ((index as f64 + 0.5) * step - 0.5).clamp(0.0, (old - 1) as f64);
                let left = place.floor() as usize;
                let share = (place - left as f64) as f32;
                return vec![(left, 1.0 - share), ((left + 1).min(old - 1), share)];
            }
            let (from, to) = (index as f64 * step, (index as f64 + 1.0) * step);
            let last = (to.ceil() as usize).min(old);
            (from.floor() as usize..last)
                .map(|i| {
                    let covered = (to.min(i as f64 + 1.0) - from.max(i as f64)).max(0.0);
                    (i, (covered / step) as f32)
                })
                .collect()
        })
        .collect()
}
