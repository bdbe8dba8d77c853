//! A canvas as pixels.

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::{Color, RGBColor, ShapeStyle};
use realgap_core::font::rasterise;
use realgap_core::{Error, Result};

use crate::canvas::{Align, Canvas, Mark, Point, Text, corners, distance, on_grid};

/// Every pixel is the average of this many by this many finer pixels, which makes lines smooth and letters evenly spaced.
const OVERSAMPLING: u32 = 3;

/// The pixels of a picture, three bytes each, row by row.
///
/// # Errors
/// An error of the rasterizer of plotters; no picture is known to cause one.
pub fn pixels(canvas: &Canvas, (width, height): (u32, u32)) -> Result<Vec<u8>> {
    let large = (width * OVERSAMPLING, height * OVERSAMPLING);
    let mut pixels = vec![255; large.0 as usize * large.1 as usize * 3];
    let mut raster = Raster(BitMapBackend::with_buffer(&mut pixels, large));
    canvas
        .marks
        .iter()
        .try_for_each(|mark| raster.draw(mark))
        .and_then(|()| raster.0.present().map_err(|failure| failure.to_string()))
        .map_err(|failure| Error::invalid(format!("cannot draw the picture: {failure}")))?;
    drop(raster);
    Ok(average(&pixels, width as usize, height as usize))
}

/// The pixels that marks are drawn on.
struct Raster<'a>(BitMapBackend<'a>);

/// A point on the finer grid.
fn at(point: Point) -> (i32, i32) {
    on_grid(point, OVERSAMPLING)
}

impl Raster<'_> {
    fn draw(&mut self, mark: &Mark) -> std::result::Result<(), String> {
        match mark {
            &Mark::Rectangle(from, to, colour) => {
                let (a, b) = corners(from, to);
                let style = ShapeStyle::from(colour).filled();
                self.0
                    .draw_rect(at(a), at(b), &style, true)
                    .map_err(|failure| failure.to_string())
            }
            Mark::Polygon(points, colour) => self.polygon(points, *colour),
            &Mark::Disc(centre, radius, colour) => self.disc(centre, radius, colour),
            Mark::Line(points, width, colour) => self.line(points, *width, *colour),
            Mark::Text(text) => self.text(text),
        }
    }

    fn polygon(&mut self, points: &[Point], colour: RGBColor) -> std::result::Result<(), String> {
        let points: Vec<_> = points.iter().map(|&point| at(point)).collect();
        self.0
            .fill_polygon(points, &ShapeStyle::from(colour).filled())
            .map_err(|failure| failure.to_string())
    }

    fn disc(
        &mut self,
        centre: Point,
        radius: f64,
        colour: RGBColor,
    ) -> std::result::Result<(), String> {
        let radius = (radius * f64::from(OVERSAMPLING)).round().max(1.0) as u32;
        self.0
            .draw_circle(at(centre), radius, &ShapeStyle::from(colour).filled(), true)
            .map_err(|failure| failure.to_string())
    }

    /// Draws a path piece by piece with round corners: thick paths of plotters have spikes at sharp corners.
    fn line(
        &mut self,
        points: &[Point],
        width: f64,
        colour: RGBColor,
    ) -> std::result::Result<(), String> {
        let half = width / 2.0;
        for pair in points.windows(2) {
            let length = distance(pair[0], pair[1]);
            if length < 1e-9 {
                continue;
            }
            let (x, y) = (
                -(pair[1].1 - pair[0].1) / length * half,
                (pair[1].0 - pair[0].0) / length * half,
            );
            let [a, b] = [pair[0], pair[1]];
            let one = [(a.0 + x, a.1 + y), (b.0 + x, b.1 + y)];
            let other = [(b.0 - x, b.1 - y), (a.0 - x, a.1 - y)];
            self.polygon(&[one, other].concat(), colour)?;
        }
        points
            .iter()
            .try_for_each(|&point| self.disc(point, half, colour))
    }

    fn text(&mut self, text: &Text) -> std::result::Result<(), String> {
        let Text { letter, anchor, .. } = text;
        let before = match text.align {
            Align::Left => 0.0,
            Align::Centre => letter.width(&text.text) / 2.0,
            Align::Right => letter.width(&text.text),
        };
        let (x, y) = if text.upwards {
            at((anchor.0, anchor.1 + before))
        } else {
            at((anchor.0 - before, anchor.1))
        };
        let mut outcome = Ok(());
        let size = letter.size * f64::from(OVERSAMPLING);
        rasterise(&text.text, letter.weight, size, |dx, dy, coverage| {
            let spot = if text.upwards {
                (x + dy, y - dx)
            } else {
                (x + dx, y + dy)
            };
            let colour = letter.colour.mix(coverage).to_backend_color();
            if let Err(failure) = self.0.draw_pixel(spot, colour) {
                outcome = Err(failure.to_string());
            }
        });
        outcome
    }
}

/// The mean of each block of `OVERSAMPLING` × `OVERSAMPLING` pixels.
fn average(large: &[u8], width: usize, height: usize) -> Vec<u8> {
    let factor = OVERSAMPLING as usize;
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
