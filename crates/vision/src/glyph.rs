//! Segments a picture of text into rows of glyphs: threshold, noise filter, rotation by the Hough transform, projections.

use super::filter::otsu;
use super::picture::Grey;

/// Side of the square, in pixels, to which glyphs are scaled before they are compared.
pub(super) const SIDE: usize = 20;

/// One glyph of a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glyph {
    /// Ink, 0 to 1, scaled to [`SIDE`] by [`SIDE`] pixels.
    pub shape: Vec<f32>,
    /// Left side and size in fractions of a pixel; rows and columns that are partly ink count partly.
    pub left_px: f64,
    pub wide_px: f64,
    pub high_px: f64,
    /// Lower end of the ink, from the top of the picture, in fractions of a pixel.
    pub bottom_px: f64,
}

/// The amount of ink at each pixel, 0 to 1, for dark text on a bright background at any brightness.
pub(super) fn inked(text: &Grey) -> Grey {
    let threshold = otsu(text);
    let mean_of = |is_ink: bool| {
        let (mut sum, mut count) = (0.0_f64, 0.0_f64);
        for v in text.values().iter().filter(|v| (**v < threshold) == is_ink) {
            sum += f64::from(*v);
            count += 1.0;
        }
        (count > 0.0).then(|| (sum / count) as f32)
    };
    match (mean_of(true), mean_of(false)) {
        (Some(ink), Some(paper)) if paper > ink => {
            text.map(|v| ((paper - v) / (paper - ink)).clamp(0.0, 1.0))
        }
        _ => text.map(|_| 0.0),
    }
}

/// A patch of ink below this share of the usual size of a patch is noise. The dot of an i is about a fifteenth of a letter's ink.
pub(super) const LEAST_SPOT: f64 = 0.035;

/// The ink without noise: patches (8 neighbours) below the share `least` of the usual size are removed. The usual size is that of the
/// patch that contains the median pixel of ink, with patches ordered by size.
pub(super) fn without_spots(ink: &Grey, least: f64) -> Grey {
    let (width, height) = (ink.width(), ink.height());
    let mut patches = patches(ink);
    patches.sort_by_key(Vec::len);
    let total: usize = patches.iter().map(Vec::len).sum();
    let mut passed = 0;
    let usual = patches.iter().map(Vec::len).find(|size| {
        passed += size;
        2 * passed >= total
    });
    let smallest = (least * usual.unwrap_or(0) as f64).max(2.0);
    let mut keep = vec![false; width * height];
    for patch in patches.iter().filter(|p| p.len() as f64 >= smallest) {
        patch.iter().for_each(|i| keep[*i] = true);
    }
    // Faint ink next to kept patches is kept, too, so that glyphs keep their soft borders.
    let near = |x: usize, y: usize| {
        (y.saturating_sub(1)..=(y + 1).min(height - 1)).any(|ny| {
            (x.saturating_sub(1)..=(x + 1).min(width - 1)).any(|nx| keep[ny * width + nx])
        })
    };
    Grey::from_fn(width, height, |x, y| {
        let value = ink.values()[y * width + x];
        if value > 0.0 && near(x, y) {
            value
        } else {
            0.0
        }
    })
}

/// The connected patches of ink, as indices of pixels.
fn patches(ink: &Grey) -> Vec<Vec<usize>> {
    let (width, height) = (ink.width(), ink.height());
    let is_ink = |i: usize| ink.values()[i] > 0.5;
    let mut seen = vec![false; width * height];
    let mut found = Vec::new();
    for first in 0..width * height {
        if seen[first] || !is_ink(first) {
            continue;
        }
        seen[first] = true;
        let (mut patch, mut next) = (vec![first], 0);
        while let Some(here) = patch.get(next).copied() {
            next += 1;
            let (x, y) = (here % width, here / width);
            for ny in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                for nx in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    let beside = ny * width + nx;
                    if !seen[beside] && is_ink(beside) {
                        seen[beside] = true;
                        patch.push(beside);
                    }
                }
            }
        }
        found.push(patch);
    }
    found
}

/// Largest number of pixels of ink that are used in the Hough transform.
const VOTERS: usize = 40_000;

/// The angle of the rows of text (x towards y), within ± `most_rad`: the angle with the largest sum of squared votes of all lines in the
/// Hough transform of the ink.
pub(super) fn hough_angle_rad(ink: &Grey, most_rad: f64) -> f64 {
    let width = ink.width();
    let mut voters: Vec<(f64, f64)> = (0..ink.values().len())
        .filter(|i| ink.values()[*i] > 0.5)
        .map(|i| ((i % width) as f64, (i / width) as f64))
        .collect();
    if voters.len() > VOTERS {
        let every = voters.len().div_ceil(VOTERS);
        voters = voters.into_iter().step_by(every).collect();
    }
    if voters.is_empty() {
        return 0.0;
    }
    let reach = (ink.width() + ink.height()) as f64;
    let votes = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let mut lines = vec![0.0_f64; 2 * reach as usize + 2];
        for (x, y) in &voters {
            // Each vote is divided between the two nearest lines, so that rounding does not favour any angle.
            let line = y * cos - x * sin + reach;
            let (whole, share) = (line.floor(), line - line.floor());
            lines[whole as usize] += 1.0 - share;
            lines[whole as usize + 1] += share;
        }
        lines.iter().map(|n| n * n).sum::<f64>()
    };
    let search = |from: f64, to: f64, steps: i32| {
        (0..=steps)
            .map(|k| from + (to - from) * f64::from(k) / f64::from(steps))
            .map(|angle| (angle, votes(angle)))
            .fold((0.0, f64::NEG_INFINITY), |best, next| {
                if next.1 > best.1 { next } else { best }
            })
            .0
    };
    let half_degree = 0.5_f64.to_radians();
    let coarse = search(-most_rad, most_rad, (2.0 * most_rad / half_degree) as i32);
    search(coarse - half_degree, coarse + half_degree, 20)
}

/// The runs of consecutive indices for which `is_there` is true, as start and end (excluded).
fn runs(count: usize, is_there: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut from = None;
    for place in 0..=count {
        let there = place < count && is_there(place);
        match (from, there) {
            (None, true) => from = Some(place),
            (Some(start), false) => {
                found.push((start, place));
                from = None;
            }
            _ => {}
        }
    }
    found
}

/// Rows whose height is below this share of the largest height are noise.
const LOWEST_ROW: f64 = 0.2;

/// The rows of a text with their glyphs, by projecting the ink onto the vertical axis, and each row onto the horizontal axis.
pub(super) fn rows(ink: &Grey) -> Vec<Vec<Glyph>> {
    let (width, height) = (ink.width(), ink.height());
    let is_ink = |x: usize, y: usize| ink.values()[y * width + x] > 0.5;
    let lines = runs(height, |y| (0..width).any(|x| is_ink(x, y)));
    let highest = lines.iter().map(|(a, b)| b - a).max().unwrap_or(0) as f64;
    lines
        .into_iter()
        .filter(|(from, to)| (to - from) as f64 >= LOWEST_ROW * highest)
        .map(|(from, to)| {
            runs(width, |x| (from..to).any(|y| is_ink(x, y)))
                .into_iter()
                .map(|(left, right)| {
                    let has = |y: &usize| (left..right).any(|x| is_ink(x, *y));
                    let top = (from..to).find(has).unwrap_or(from);
                    let last = (from..to).rev().find(has).unwrap_or(top);
                    cut(ink, [left, right], [top, last + 1])
                })
                .collect()
        })
        .collect()
}

/// The glyph within these columns and rows (the ends excluded).
fn cut(ink: &Grey, [left, right]: [usize; 2], [top, bottom]: [usize; 2]) -> Glyph {
    let most = |values: &mut dyn Iterator<Item = f32>| f64::from(values.fold(0.0_f32, f32::max));
    let row = |y: i64| {
        let is_inside = (0..ink.height() as i64).contains(&y);
        most(
            &mut (left..right)
                .filter(|_| is_inside)
                .map(|x| ink.at(x as i64, y)),
        )
    };
    let column = |x: i64| {
        let is_inside = (0..ink.width() as i64).contains(&x);
        most(
            &mut (top..bottom)
                .filter(|_| is_inside)
                .map(|y| ink.at(x, y as i64)),
        )
    };
    let (t, b, l, r) = (top as i64, bottom as i64, left as i64, right as i64);
    // The position of an edge in fractions of a pixel, from the ink in the outermost row or column and in the one beyond it.
    let beyond = |outside: f64, edge: f64| outside + edge - 1.0;
    let left_px = left as f64 - beyond(column(l - 1), column(l));
    let right_px = right as f64 + beyond(column(r), column(r - 1));
    let top_px = top as f64 - beyond(row(t - 1), row(t));
    let bottom_px = bottom as f64 + beyond(row(b), row(b - 1));
    let (wide_px, high_px) = ((right_px - left_px).max(0.5), (bottom_px - top_px).max(0.5));
    // The glyph is sampled at two positions for each pixel along each side.
    const PLACES: usize = 2 * SIDE;
    let at = |from: f64, size: f64, k: usize| from + size * (k as f64 + 0.5) / PLACES as f64 - 0.5;
    let fine = Grey::from_fn(PLACES, PLACES, |x, y| {
        ink.between(at(left_px, wide_px, x), at(top_px, high_px, y))
    });
    Glyph {
        shape: fine.resized(SIDE, SIDE).values().to_vec(),
        left_px,
        wide_px,
        high_px,
        bottom_px,
    }
}
