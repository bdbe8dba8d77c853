//! Image filters that several extractors use: Gaussian filter, Sobel operator, Otsu's threshold.

use super::picture::Grey;

/// The kernel of the Gaussian filter is truncated at this many standard deviations.
const TRUNCATED: f64 = 4.0;

/// Gaussian filter; beyond the border the value of the nearest pixel is used, as in
/// `scipy.ndimage.gaussian_filter(mode="nearest")`.
pub fn gauss(picture: &Grey, sigma_px: f64) -> Grey {
    let reach = (TRUNCATED * sigma_px + 0.5) as i64;
    if reach <= 0 {
        return picture.clone();
    }
    let mut weights: Vec<f64> = (-reach..=reach)
        .map(|i| (-0.5 * (i as f64 / sigma_px).powi(2)).exp())
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    across(&down(picture, &weights), &weights)
}

/// Weighted sums along columns, computed for a whole row at once.
fn down(picture: &Grey, weights: &[f64]) -> Grey {
    let (width, last) = (picture.width(), picture.height() as i64 - 1);
    let reach = (weights.len() / 2) as i64;
    let row = |y: i64| {
        let from = y.clamp(0, last) as usize * width;
        &picture.values()[from..from + width]
    };
    let rows = (0..picture.height()).map(|y| {
        let y = y as i64;
        let mut sums = vec![0.0; width];
        for (weight, i) in weights.iter().zip(-reach..) {
            for (sum, value) in sums.iter_mut().zip(row(y + i)) {
                *sum += weight * f64::from(*value);
            }
        }
        sums
    });
    Grey::from_rows(width, rows)
}

/// Weighted sums along rows.
fn across(picture: &Grey, weights: &[f64]) -> Grey {
    let (width, reach) = (picture.width(), weights.len() / 2);
    let rows = picture.values().chunks_exact(width).map(|row| {
        let beyond = |value: f32| std::iter::repeat_n(value, reach);
        let longer: Vec<f64> = beyond(row[0])
            .chain(row.iter().copied())
            .chain(beyond(row[width - 1]))
            .map(f64::from)
            .collect();
        let mut sums = vec![0.0; width];
        for (k, weight) in weights.iter().enumerate() {
            for (sum, value) in sums.iter_mut().zip(&longer[k..]) {
                *sum += weight * value;
            }
        }
        sums
    });
    Grey::from_rows(width, rows)
}

/// The Sobel derivatives to the right and down at a pixel, per pixel (the kernel divided by 8).
pub(super) fn slopes(picture: &Grey, x: usize, y: usize) -> (f32, f32) {
    let (x, y) = (x as i64, y as i64);
    let right = |i: i64| picture.at(x + 1, y + i) - picture.at(x - 1, y + i);
    let down = |i: i64| picture.at(x + i, y + 1) - picture.at(x + i, y - 1);
    (
        0.125 * (right(-1) + 2.0 * right(0) + right(1)),
        0.125 * (down(-1) + 2.0 * down(0) + down(1)),
    )
}

/// The Sobel derivatives to the right and down at every pixel.
pub fn sobel(picture: &Grey) -> (Grey, Grey) {
    let (width, height) = (picture.width(), picture.height());
    (
        Grey::from_fn(width, height, |x, y| slopes(picture, x, y).0),
        Grey::from_fn(width, height, |x, y| slopes(picture, x, y).1),
    )
}

/// The magnitude of the gradient at every pixel, from the two Sobel derivatives.
pub fn steepness(picture: &Grey) -> Grey {
    Grey::from_fn(picture.width(), picture.height(), |x, y| {
        let (dx, dy) = slopes(picture, x, y);
        dx.hypot(dy)
    })
}

/// Number of bins of the histogram in [`otsu`].
const BINS: usize = 256;

/// The threshold that splits the values into two groups whose means are farthest apart (Otsu 1979).
pub fn otsu(picture: &Grey) -> f32 {
    let (low, high) = picture
        .values()
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| {
            (l.min(*v), h.max(*v))
        });
    if high <= low {
        return low;
    }
    let bin = |v: f32| (((v - low) / (high - low) * BINS as f32) as usize).min(BINS - 1);
    let mut counts = [0.0_f64; BINS];
    picture.values().iter().for_each(|v| counts[bin(*v)] += 1.0);
    let total: f64 = counts.iter().sum();
    let sum: f64 = counts.iter().enumerate().map(|(i, n)| i as f64 * n).sum();
    let (mut below, mut sum_below) = (0.0, 0.0);
    let mut best = (f64::NEG_INFINITY, 0, 0);
    for (index, count) in counts.iter().enumerate() {
        below += count;
        sum_below += index as f64 * count;
        let above = total - below;
        if below == 0.0 || above == 0.0 {
            continue;
        }
        let difference = sum_below / below - (sum - sum_below) / above;
        let between = below * above * difference * difference;
        // All thresholds in empty bins between two groups are equally good; the middle one is used.
        if between > best.0 * (1.0 + 1e-12) {
            best = (between, index, index);
        } else if between >= best.0 * (1.0 - 1e-12) {
            best.2 = index;
        }
    }
    let middle = 0.5 * (best.1 + best.2) as f32 + 1.0;
    low + (high - low) * middle / BINS as f32
}
