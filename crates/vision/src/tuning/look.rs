//! Statistics of a picture for a known scene: brightness, noise and sharpness.

use crate::{Grey, Picture, gauss, steepness};
use realgap_core::error::Result;

use super::correspondence::toned;

/// Number of groups of pixels by simulated brightness.
const GROUPS: usize = 4;
/// Share of the pixels of each group that count as flat, and share of all pixels that count as edges.
const FLAT: f64 = 0.4;
const EDGES: f64 = 0.03;
/// Added to a change before its logarithm is taken, because smaller changes are not significant; grey values.
const LEAST: f64 = 1e-4;

/// The pixels of one picture that are flat according to the simulation, and those that are edges.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    flat: Vec<Vec<usize>>,
    edges: Vec<usize>,
}

impl Parts {
    pub(super) fn new(light: &[Grey; 3]) -> Result<Self> {
        let tone = gauss(&toned(light)?, 1.5);
        let steep = steepness(&tone);
        let (width, height) = (tone.width(), tone.height());
        let mut inner: Vec<usize> = (3..height.saturating_sub(3))
            .flat_map(|y| (3..width.saturating_sub(3)).map(move |x| y * width + x))
            .collect();
        let by = |values: &[f32]| {
            let values = values.to_vec();
            move |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]).then(a.cmp(b))
        };
        inner.sort_by(by(steep.values()));
        let last = (EDGES * inner.len() as f64).ceil() as usize;
        let edges = inner[inner.len() - last..].to_vec();
        inner.sort_by(by(tone.values()));
        let size = inner.len().div_ceil(GROUPS).max(1);
        let flat = inner.chunks(size).map(|group| {
            let mut own = group.to_vec();
            own.sort_by(by(steep.values()));
            own.truncate((FLAT * own.len() as f64).ceil() as usize);
            own
        });
        Ok(Self {
            flat: flat.collect(),
            edges,
        })
    }
}

/// The kind of a statistic of [`look`]: brightness, fine noise, coarse noise (each for every group), or sharpness.
pub(super) fn kind(number: usize) -> usize {
    if number < 3 * GROUPS { number % 3 } else { 3 }
}

/// The statistics of a picture.
pub(super) fn look(picture: &Picture, parts: &Parts) -> Vec<f64> {
    let grey = picture.grey();
    let (width, values) = (grey.width() as i64, grey.values());
    let mean = |places: &[usize], of: &dyn Fn(usize) -> f64| {
        places.iter().map(|i| of(*i)).sum::<f64>() / places.len().max(1) as f64
    };
    let at = |index: usize, dx: i64, dy: i64| {
        f64::from(values[(index as i64 + dy * width + dx) as usize])
    };
    let ln = |value: f64| libm::log(value + LEAST);
    // Immerkær's mask (1996), which is 0 for constant and linear brightness.
    let fine = |i: usize| {
        let cross = at(i, -1, 0) + at(i, 1, 0) + at(i, 0, -1) + at(i, 0, 1);
        let corners = at(i, -1, -1) + at(i, 1, -1) + at(i, -1, 1) + at(i, 1, 1);
        (corners - 2.0 * cross + 4.0 * at(i, 0, 0)).abs() / 6.0
    };
    let coarse = |i: usize| {
        let cross = at(i, -3, 0) + at(i, 3, 0) + at(i, 0, -3) + at(i, 0, 3);
        (cross - 4.0 * at(i, 0, 0)).abs() / 4.5
    };
    let mut found = Vec::new();
    for flat in &parts.flat {
        // Only flat pixels are used, because the brightness near edges depends on small errors of the camera's pose.
        found.push(mean(flat, &|i| at(i, 0, 0)));
        found.push(ln(mean(flat, &fine)));
        found.push(ln(mean(flat, &coarse)));
    }
    let slope = |i: usize| (at(i, 1, 0) - at(i, -1, 0)).hypot(at(i, 0, 1) - at(i, 0, -1)) / 2.0;
    let bend = |i: usize| {
        let (x, y) = (at(i, 1, 0) + at(i, -1, 0), at(i, 0, 1) + at(i, 0, -1));
        (x - 2.0 * at(i, 0, 0)).hypot(y - 2.0 * at(i, 0, 0))
    };
    let wide = |i: usize| (at(i, 3, 0) - at(i, -3, 0)).hypot(at(i, 0, 3) - at(i, 0, -3)) / 6.0;
    found.extend(
        [&slope as &dyn Fn(usize) -> f64, &bend, &wide].map(|of| ln(mean(&parts.edges, of))),
    );
    found
}
