//! Draws the steps of an extractor side by side, as in figures 2, 3, 4 and 9 of paper 002.

use super::extractor::Step;
use super::picture::{Grey, check_size};
use realgap_core::error::Result;
use realgap_core::font::{self, Weight};

/// Height of a step, size of the caption's letters, space around a step, and height of the caption, pixels.
const HEIGHT: usize = 300;
const LETTER: f64 = 20.0;
const SPACE: usize = 14;
const CAPTION: usize = 34;

/// The steps in one row, each with its name below it.
pub fn contact_sheet(steps: &[Step]) -> Grey {
    let shown: Vec<(Grey, &str)> = steps
        .iter()
        .map(|step| {
            let (width, height) = (step.picture.width(), step.picture.height());
            // Small pictures, such as templates, are enlarged at most three times.
            let factor = (HEIGHT as f64 / height as f64)
                .min(3.0)
                .min(4.0 * HEIGHT as f64 / width as f64);
            let side = |pixels: usize| ((pixels as f64 * factor).round() as usize).max(1);
            (step.picture.resized(side(width), side(height)), step.name)
        })
        .collect();
    let column = |picture: &Grey, name: &str| {
        let text = font::text_width(name, Weight::Regular, LETTER).ceil() as usize;
        picture.width().max(text)
    };
    let width = SPACE
        + shown
            .iter()
            .map(|(p, n)| column(p, n) + SPACE)
            .sum::<usize>();
    let height = HEIGHT + SPACE + CAPTION;
    let mut values = vec![1.0_f32; width * height];
    let mut left = SPACE;
    for (picture, name) in &shown {
        for y in 0..picture.height() {
            let to = (SPACE + y) * width + left;
            let from = y * picture.width();
            values[to..to + picture.width()]
                .copy_from_slice(&picture.values()[from..from + picture.width()]);
        }
        let baseline = SPACE + picture.height() + 24;
        font::rasterise(name, Weight::Regular, LETTER, |dx, dy, coverage| {
            let (x, y) = (left as i32 + dx, baseline as i32 + dy);
            if x >= 0 && y >= 0 && (x as usize) < width && (y as usize) < height {
                let value = &mut values[y as usize * width + x as usize];
                *value = value.min(1.0 - coverage as f32);
            }
        });
        left += column(picture, name) + SPACE;
    }
    Grey::from_fn(width, height, |x, y| values[y * width + x])
}

/// Pictures below each other, on a white background.
///
/// # Errors
/// The result would have more pixels than a picture may have.
pub fn stacked(rows: &[Grey]) -> Result<Grey> {
    let width = rows.iter().map(Grey::width).max().unwrap_or(1);
    let height = rows.iter().map(Grey::height).sum::<usize>().max(1);
    check_size(width, height)?;
    let mut values = vec![1.0_f32; width * height];
    let mut top = 0;
    for row in rows {
        for (y, line) in row.values().chunks_exact(row.width()).enumerate() {
            let to = (top + y) * width;
            values[to..to + row.width()].copy_from_slice(line);
        }
        top += row.height();
    }
    Grey::new(width, height, values)
}
