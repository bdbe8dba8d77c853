//! Computes the normalised correlation of a picture with templates in the Fourier domain (Lewis 1995).
//!
//! The picture is processed in overlapping blocks, so that the memory does not grow with its size. One inverse transform serves two
//! templates: one is in the real part, the other in the imaginary part.

use rustfft::num_complex::Complex;
use rustfft::{FftDirection, FftPlanner};
use std::sync::Arc;

use super::picture::Grey;
use realgap_core::error::{Error, Result};

type Value = Complex<f64>;
const ZERO: Value = Complex::new(0.0, 0.0);

/// Side of a block that is transformed at once, pixels, unless a template needs a larger block.
const BLOCK: usize = 512;

/// A square two-dimensional transform.
struct Transform {
    side: usize,
    forward: Arc<dyn rustfft::Fft<f64>>,
    inverse: Arc<dyn rustfft::Fft<f64>>,
}

impl Transform {
    fn new(side: usize) -> Self {
        let mut planner = FftPlanner::new();
        Self {
            side,
            forward: planner.plan_fft(side, FftDirection::Forward),
            inverse: planner.plan_fft(side, FftDirection::Inverse),
        }
    }

    /// Transforms rows, then columns. The result is transposed; the inverse transform transposes it back.
    fn run(&self, values: &mut Vec<Value>, is_inverse: bool) {
        let fft = if is_inverse {
            &self.inverse
        } else {
            &self.forward
        };
        fft.process(values);
        *values = transposed(values, self.side);
        fft.process(values);
    }
}

fn transposed(values: &[Value], side: usize) -> Vec<Value> {
    // The transposition works on small squares, so that both sides stay in the cache.
    const SQUARE: usize = 16;
    let mut turned = vec![ZERO; values.len()];
    for top in (0..side).step_by(SQUARE) {
        for left in (0..side).step_by(SQUARE) {
            for y in top..(top + SQUARE).min(side) {
                for x in left..(left + SQUARE).min(side) {
                    turned[x * side + y] = values[y * side + x];
                }
            }
        }
    }
    turned
}

/// Summed-area tables of values and of their squares.
struct Sums {
    stride: usize,
    plain: Vec<f64>,
    squares: Vec<f64>,
}

impl Sums {
    fn new(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let stride = width + 1;
        let mut plain = vec![0.0; stride * (height + 1)];
        let mut squares = plain.clone();
        for y in 0..height {
            let (mut sum, mut sum_of_squares) = (0.0, 0.0);
            for x in 0..width {
                let v = value(x, y);
                sum += v;
                sum_of_squares += v * v;
                let here = (y + 1) * stride + x + 1;
                plain[here] = plain[here - stride] + sum;
                squares[here] = squares[here - stride] + sum_of_squares;
            }
        }
        Self {
            stride,
            plain,
            squares,
        }
    }

    fn over(&self, x: usize, y: usize, width: usize, height: usize) -> (f64, f64) {
        let (upper, lower) = (y * self.stride, (y + height) * self.stride);
        let of = |sums: &[f64]| {
            sums[lower + x + width] - sums[lower + x] - sums[upper + x + width] + sums[upper + x]
        };
        (of(&self.plain), of(&self.squares))
    }
}

/// A template after subtraction of its mean.
struct Pattern {
    width: usize,
    height: usize,
    values: Vec<f64>,
    /// Sum of the squares.
    energy: f64,
}

impl Pattern {
    fn new(template: &Grey) -> Self {
        let count = template.values().len() as f64;
        let mean = template.values().iter().map(|v| f64::from(*v)).sum::<f64>() / count;
        let values: Vec<f64> = template
            .values()
            .iter()
            .map(|v| f64::from(*v) - mean)
            .collect();
        Self {
            width: template.width(),
            height: template.height(),
            energy: values.iter().map(|v| v * v).sum(),
            values,
        }
    }
}

/// The common spectrum of two templates, one in the real part and one in the imaginary part.
fn spectrum(pair: &[Pattern], side: usize, transform: &Transform) -> Vec<Value> {
    let mut values = vec![ZERO; side * side];
    for (part, pattern) in pair.iter().enumerate() {
        for (index, v) in pattern.values.iter().enumerate() {
            // The template is rotated by 180°, so that the convolution with it is the correlation.
            let x = pattern.width - 1 - index % pattern.width;
            let y = pattern.height - 1 - index / pattern.width;
            let place = &mut values[y * side + x];
            if part == 0 {
                place.re = *v;
            } else {
                place.im = *v;
            }
        }
    }
    transform.run(&mut values, false);
    values
}

/// Calls `visit(template, x, y, r)` with the normalised correlation r of every template at every position at which it is wholly inside of
/// the picture; (x, y) is the position of the template's top left pixel. r is 0 if the template or that part of the picture is
/// uniform.
///
/// # Errors
/// A template that is larger than the picture.
pub fn correlate(
    picture: &Grey,
    templates: &[Grey],
    mut visit: impl FnMut(usize, usize, usize, f64),
) -> Result<()> {
    for template in templates {
        if template.width() > picture.width() || template.height() > picture.height() {
            return Err(Error::invalid("the template is larger than the picture")
                .field("template")
                .found(format!("{} x {} px", template.width(), template.height()))
                .allowed(format!(
                    "at most {} x {} px",
                    picture.width(),
                    picture.height()
                )));
        }
    }
    let side_of = |grey: &Grey| grey.width().max(grey.height());
    let Some(largest) = templates.iter().map(side_of).max() else {
        return Ok(());
    };
    let whole = side_of(picture).next_power_of_two();
    let side = (2 * largest).next_power_of_two().max(BLOCK).min(whole);
    let step = side - largest + 1;
    let transform = Transform::new(side);
    let patterns: Vec<Pattern> = templates.iter().map(Pattern::new).collect();
    let pairs = patterns.chunks(2);
    let spectra: Vec<Vec<Value>> = pairs.map(|pair| spectrum(pair, side, &transform)).collect();
    let scale = 1.0 / (side * side) as f64;
    for top in (0..picture.height()).step_by(step) {
        for left in (0..picture.width()).step_by(step) {
            let width = side.min(picture.width() - left);
            let height = side.min(picture.height() - top);
            let value = |x: usize, y: usize| {
                f64::from(picture.values()[(top + y) * picture.width() + left + x])
            };
            // The mean of the block is subtracted to reduce rounding errors of the sums of squares.
            let mean = {
                let row = |y| (0..width).map(|x| value(x, y)).sum::<f64>();
                (0..height).map(row).sum::<f64>() / (width * height) as f64
            };
            let mut block = vec![ZERO; side * side];
            for y in 0..height {
                for x in 0..width {
                    block[y * side + x].re = value(x, y) - mean;
                }
            }
            transform.run(&mut block, false);
            let sums = Sums::new(width, height, |x, y| value(x, y) - mean);
            for (pair, spectrum) in spectra.iter().enumerate() {
                let mut product: Vec<Value> =
                    block.iter().zip(spectrum).map(|(a, b)| a * b).collect();
                transform.run(&mut product, true);
                for (part, pattern) in patterns[2 * pair..].iter().take(2).enumerate() {
                    if pattern.width > width || pattern.height > height {
                        continue;
                    }
                    let area = (pattern.width * pattern.height) as f64;
                    for y in 0..(height - pattern.height + 1).min(step) {
                        for x in 0..(width - pattern.width + 1).min(step) {
                            let at = (y + pattern.height - 1) * side + x + pattern.width - 1;
                            let inner = if part == 0 {
                                product[at].re
                            } else {
                                product[at].im
                            };
                            let (sum, squares) = sums.over(x, y, pattern.width, pattern.height);
                            let energy = (squares - sum * sum / area) * pattern.energy;
                            let r = if energy > f64::EPSILON {
                                (inner * scale / energy.sqrt()).clamp(-1.0, 1.0)
                            } else {
                                0.0
                            };
                            visit(2 * pair + part, left + x, top + y, r);
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

/// Width, height and values of the map of normalised correlations of one template: one value, row by row, for every position at which it
/// is wholly inside of the picture, as in scikit-image's `match_template`.
///
/// # Errors
/// The errors of [`correlate`].
pub fn correlation_map(picture: &Grey, template: &Grey) -> Result<(usize, usize, Vec<f64>)> {
    let width = (picture.width() + 1).saturating_sub(template.width());
    let height = (picture.height() + 1).saturating_sub(template.height());
    let mut map = vec![0.0; width * height];
    correlate(picture, std::slice::from_ref(template), |_, x, y, r| {
        map[y * width + x] = r;
    })?;
    Ok((width, height, map))
}
