//! The points of a sweep or a tuning, and their paths, as the scripts of a page read them.

use serde::Serialize;

use super::page_data::{PageData, recorded_of};
use crate::report::document::packed::PackedColumns;
use crate::results::study::data::{PathXy, Points};

/// Prepared paths are rounded to multiples of this in the page.
const PATH_STEP_M: f64 = 1e-4;
/// Numbers of all paths together in a page; paths of more points have fewer places.
const MOST_NUMBERS: usize = 180_000;

/// What scripts show of points and recorded paths.
#[derive(Debug, Serialize)]
pub(super) struct ShownPoints<'a> {
    names: &'a [String],
    best: usize,
    /// Values, score, whether the point cannot be told from the best.
    rows: Vec<(&'a [f64], Option<f64>, bool)>,
    /// What coordinates are whole multiples of, metres.
    step: f64,
    duration_s: f64,
    /// Name and length in seconds.
    recorded: Vec<(&'a str, f64)>,
}

impl<'a> ShownPoints<'a> {
    /// The points, and the names of the recorded paths.
    pub(super) fn new(points: &'a Points, best: usize, data: Option<&'a PageData>) -> Self {
        let rows = points.points.iter();
        let rows = rows.map(|p| (p.values.as_slice(), p.score, p.is_indistinguishable));
        let recorded = recorded_of(data).iter();
        let recorded = recorded.map(|path| (path.name.as_str(), path.duration_s));
        Self {
            names: &points.names,
            best,
            rows: rows.collect(),
            step: PATH_STEP_M,
            duration_s: data.map_or(1.0, |data| data.duration_s),
            recorded: recorded.collect(),
        }
    }
}

/// The paths of the points, then the recorded ones, as packed numbers: x, then y of each path.
pub(super) fn packed_paths(paths: &[PathXy], data: Option<&PageData>) -> String {
    let mut packed = PackedColumns::default();
    let numbers: usize = paths.iter().map(|path| 2 * path.len()).sum();
    let every = numbers.div_ceil(MOST_NUMBERS).max(1);
    for path in paths {
        push_path(&mut packed, &thinned(path, path.len().div_ceil(every)));
    }
    for path in recorded_of(data) {
        push_path(&mut packed, &path.xy_m);
    }
    packed.text()
}

fn push_path(packed: &mut PackedColumns, xy_m: &[[f64; 2]]) {
    for axis in 0..2 {
        packed.push(xy_m.iter().map(|place| place[axis]), PATH_STEP_M);
    }
}

/// A path of `count` places, again at equal steps of time.
fn thinned(path: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    if count >= path.len() || count < 2 {
        return path.to_vec();
    }
    let step = (path.len() - 1) as f64 / (count - 1) as f64;
    let place = |k: usize| {
        let at = k as f64 * step;
        let below = (at.floor() as usize).min(path.len() - 2);
        let (a, b) = (path[below], path[below + 1]);
        let share = at - below as f64;
        [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * share)
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_path_keeps_its_ends_and_its_pace() {
        let path: Vec<[f64; 2]> = (0..=10)
            .map(|k| [f64::from(k), -2.0 * f64::from(k)])
            .collect();
        assert_eq!(
            thinned(&path, 3),
            [[0.0, -0.0], [5.0, -10.0], [10.0, -20.0]]
        );
        assert_eq!(thinned(&path, 11), path);
    }
}
