//! What stands for each point of a study's grid in its pictures.

use realgap_lab::calibration::{Answer, Method, PointScore, Study};

/// What stands for each point of the grid: the point itself, or the nearest one that an optimizer chose.
pub(super) fn cells<'a>(study: &Study, answer: &'a Answer) -> Vec<Option<(&'a PointScore, bool)>> {
    let grid = &study.definition().grid;
    let is_in = |position: usize| {
        answer
            .uncertainty
            .as_ref()
            .is_some_and(|u| u.indistinguishable[position])
    };
    let points = || answer.scores.points.iter().enumerate();
    if answer.method == Method::Sweep {
        let mut cells = vec![None; grid.len()];
        for (position, point) in points() {
            cells[point.index] = Some((point, is_in(position)));
        }
        return cells;
    }
    if grid.ranges().len() > 2 {
        return Vec::new();
    }
    let nearest = |values: &[f64]| {
        let distance = |point: &PointScore| -> f64 {
            let ranges = grid.ranges().iter();
            ranges
                .zip(values.iter().zip(&point.values))
                .map(|(range, (a, b))| ((a - b) / range.step()).powi(2))
                .sum()
        };
        points()
            .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))
            .map(|(position, point)| (point, is_in(position)))
    };
    (0..grid.len())
        .map(|index| nearest(&grid.values(index)))
        .collect()
}
