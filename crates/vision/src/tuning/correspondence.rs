//! Finds correspondences between points of a scene and a real picture, by matching patches of a simulated picture in the real one.

use super::room::LitScene;
use crate::camera::{Camera, Pose, luminance, met_m};
use crate::template::top;
use crate::{Grey, gauss, sobel};
use realgap_core::error::Result;

/// A point of the scene and the position at which it is seen in the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Correspondence {
    pub point_m: [f64; 3],
    pub seen_px: [f64; 2],
}

/// Half the side of a patch, pixels.
const HALF: i64 = 6;
/// Number of cells along the longer side of a picture; at most one patch is taken from each cell.
const CELLS: usize = 20;
/// Smallest correlation at which a patch counts as found.
const LEAST_CORRELATION: f64 = 0.75;
/// A cell is skipped if its strongest corner is weaker than this share of the strongest corner of the picture.
const WEAK: f32 = 0.002;
/// Standard deviation of the Gaussian filter before patches are compared, and of that for the products of derivatives of corners,
/// pixels.
const SMOOTH_PX: f64 = 0.8;
const CORNER_PX: f64 = 1.5;

/// Luminance with a tone curve that approximates that of sRGB, so that it is about proportional to the grey values of a picture.
pub(super) fn toned(light: &[Grey; 3]) -> Result<Grey> {
    let grey = grey(light)?;
    let values = grey.values().iter().map(|value| value.max(0.0).powf(0.45));
    Grey::new(grey.width(), grey.height(), values.collect())
}

/// Grey values from red, green and blue, with the weights of [`Picture::grey`](crate::Picture::grey).
fn grey([red, green, blue]: &[Grey; 3]) -> Result<Grey> {
    let values = red.values().iter().zip(green.values()).zip(blue.values());
    let values = values.map(|((r, g), b)| 0.2125 * r + 0.7154 * g + 0.0721 * b);
    Grey::new(red.width(), red.height(), values.collect())
}

/// Searches for corners of the scene in a real picture. Both pictures are reduced to `1 / factor` of their size, and the search extends
/// `reach` reduced pixels from the position at which this camera at this pose would see a corner. If the sensor is known, the
/// simulated picture has the brightness of the real one, including saturation, which moves edges.
pub(super) fn correspondences(
    LitScene { scene, light }: LitScene<'_>,
    (camera, is_sensor_known): (&Camera, bool),
    pose: &Pose,
    real: &Grey,
    (factor, reach): (usize, i64),
) -> Result<Vec<Correspondence>> {
    let (width, height) = (real.width() / factor, real.height() / factor);
    let mut small = camera.clone();
    small.lens.width_px = width;
    small.lens.height_px = height;
    // The simulated picture is blurred like the real one, as far as the blur is known, because the best match of a sharper patch is
    // displaced.
    let blurred = luminance(scene, &small, pose, light)
        .map(|plane| gauss(&plane, camera.lens.blur_px / factor as f64));
    let tone = if is_sensor_known {
        grey(&camera.sensor.calm(&blurred))?
    } else {
        toned(&blurred)?
    };
    let model = gauss(&tone, SMOOTH_PX);
    let real_small = gauss(&real.resized(width, height), SMOOTH_PX);
    let ratio = [
        real.width() as f64 / width as f64,
        real.height() as f64 / height as f64,
    ];
    let mut places = Vec::new();
    let mut seen = Vec::new();
    for (x, y) in corners(&model, reach)? {
        let found = shift(&model, &real_small, x, y, reach);
        // Depending on the surroundings of a patch, its correlation with its own picture may not be highest at its own position, either.
        // This displacement is subtracted.
        let own = shift(&model, &model, x, y, 1);
        if let (Some([dx, dy]), Some([own_dx, own_dy])) = (found, own) {
            places.push([x as f64, y as f64]);
            let off = [x as f64 + dx - own_dx, y as f64 + dy - own_dy];
            seen.push([0, 1].map(|k| (off[k] + 0.5) * ratio[k] - 0.5));
        }
    }
    let points = met_m(scene, &small, pose, &places);
    let pairs = points.into_iter().zip(seen);
    Ok(pairs
        .map(|(point_m, seen_px)| Correspondence { point_m, seen_px })
        .collect())
}

/// The strongest corner of each cell (Shi & Tomasi 1994: the smaller eigenvalue of the structure tensor), away from the border.
fn corners(picture: &Grey, reach: i64) -> Result<Vec<(i64, i64)>> {
    let (width, height) = (picture.width(), picture.height());
    let (dx, dy) = sobel(picture);
    let product = |a: &Grey, b: &Grey| -> Result<Grey> {
        let values = a.values().iter().zip(b.values()).map(|(a, b)| a * b);
        Ok(gauss(
            &Grey::new(width, height, values.collect())?,
            CORNER_PX,
        ))
    };
    let (xx, xy, yy) = (product(&dx, &dx)?, product(&dx, &dy)?, product(&dy, &dy)?);
    let strength = |index: usize| {
        let (a, b, c) = (xx.values()[index], xy.values()[index], yy.values()[index]);
        0.5 * (a + c) - (0.25 * (a - c).powi(2) + b * b).sqrt()
    };
    let margin = (HALF + reach + 1) as usize;
    let cell = (width.max(height) / CELLS).max(4);
    let mut found: Vec<(f32, i64, i64)> = Vec::new();
    for top in (margin..height.saturating_sub(margin)).step_by(cell) {
        for left in (margin..width.saturating_sub(margin)).step_by(cell) {
            let mut best = (0.0, 0, 0);
            for y in top..(top + cell).min(height - margin) {
                for x in left..(left + cell).min(width - margin) {
                    let its = strength(y * width + x);
                    if its > best.0 {
                        best = (its, x as i64, y as i64);
                    }
                }
            }
            found.push(best);
        }
    }
    let strongest = found.iter().fold(0.0_f32, |most, f| most.max(f.0));
    let strong = found.into_iter().filter(|f| f.0 > WEAK * strongest);
    Ok(strong.map(|(_, x, y)| (x, y)).collect())
}

/// Displacement of a patch of one picture in the other, pixels; `None` if it is not found, or found at the edge of the search range.
fn shift(model: &Grey, real: &Grey, x: i64, y: i64, reach: i64) -> Option<[f64; 2]> {
    let patch = Patch::new(model, x, y);
    let side = 2 * reach + 1;
    let mut scores = Vec::with_capacity((side * side) as usize);
    for dy in -reach..=reach {
        for dx in -reach..=reach {
            scores.push(patch.correlation(real, x + dx, y + dy));
        }
    }
    let best = (0..scores.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
    let (i, j) = (best as i64 % side, best as i64 / side);
    if scores[best] < LEAST_CORRELATION || i == 0 || j == 0 || i == side - 1 || j == side - 1 {
        return None;
    }
    let at = |i: i64, j: i64| scores[(j * side + i) as usize];
    Some([
        (i - reach) as f64 + top(at(i - 1, j), at(i, j), at(i + 1, j)),
        (j - reach) as f64 + top(at(i, j - 1), at(i, j), at(i, j + 1)),
    ])
}

/// A patch of a picture after subtraction of its mean.
struct Patch {
    values: Vec<f64>,
    squares: f64,
}

impl Patch {
    fn new(picture: &Grey, x: i64, y: i64) -> Self {
        let mut values: Vec<f64> = Vec::with_capacity(((2 * HALF + 1) * (2 * HALF + 1)) as usize);
        for dy in -HALF..=HALF {
            values.extend((-HALF..=HALF).map(|dx| f64::from(picture.at(x + dx, y + dy))));
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter_mut().for_each(|v| *v -= mean);
        let squares = values.iter().map(|v| v * v).sum();
        Self { values, squares }
    }

    /// Normalised correlation with the patch at this position of a picture; 0 if that patch is uniform.
    fn correlation(&self, picture: &Grey, x: i64, y: i64) -> f64 {
        let (mut sum, mut squares, mut product) = (0.0, 0.0, 0.0);
        let mut own = self.values.iter();
        for dy in -HALF..=HALF {
            for dx in -HALF..=HALF {
                let value = f64::from(picture.at(x + dx, y + dy));
                sum += value;
                squares += value * value;
                product += value * own.next().copied().unwrap_or(0.0);
            }
        }
        let spread = squares - sum * sum / self.values.len() as f64;
        if spread > 1e-12 && self.squares > 1e-12 {
            product / (spread * self.squares).sqrt()
        } else {
            0.0
        }
    }
}
