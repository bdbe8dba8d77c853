//! Cells of the pictures of a study: which point each cell of the grid shows, and which cells belong to the confidence set.

use std::collections::BTreeSet;

use realgap_lab::calibration::{Answer, Method, PointScore, Study};

/// The point that each cell of the grid shows: the point of the cell itself, or the nearest point that an optimizer chose.
pub(super) fn cells<'a>(study: &Study, answer: &'a Answer) -> Vec<Option<&'a PointScore>> {
    let grid = &study.definition().grid;
    let points = &answer.scores.points;
    if answer.method == Method::Sweep {
        let mut cells = vec![None; grid.len()];
        for point in points.iter().filter(|point| point.index < grid.len()) {
            cells[point.index] = Some(point);
        }
        return cells;
    }
    if grid.ranges().len() > 2 {
        return Vec::new();
    }
    let nearest = |values: &[f64]| {
        let distance = |point: &PointScore| -> f64 {
            let pairs = values.iter().zip(&point.values);
            let steps = grid.ranges().iter().zip(pairs);
            let steps = steps.map(|(range, (a, b))| ((a - b) / range.step()).powi(2));
            steps.sum()
        };
        let points = points.iter();
        points.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let cells = (0..grid.len()).map(|index| nearest(&grid.values(index)));
    cells.collect()
}

/// Whether the point at this place of the scores cannot be told from the best.
pub(super) fn is_alike(answer: &Answer, point: usize) -> bool {
    let uncertainty = answer.uncertainty.as_ref();
    uncertainty.is_some_and(|u| u.indistinguishable[point])
}

/// The cells of the grid that cannot be told from the best: those whose own values belong to the confidence set.
pub(super) fn in_set(study: &Study, answer: &Answer) -> BTreeSet<usize> {
    let grid = &study.definition().grid;
    let Some(uncertainty) = &answer.uncertainty else {
        return BTreeSet::new();
    };
    let points = answer.scores.points.iter();
    let points = points.zip(&uncertainty.indistinguishable);
    let inside = points.filter(|(_, is_in)| **is_in).map(|(point, _)| point);
    if answer.method == Method::Sweep {
        let on_grid = inside.map(|point| point.index);
        return on_grid.filter(|index| *index < grid.len()).collect();
    }
    if !uncertainty.cells.is_empty() {
        let cells = uncertainty.cells.iter().enumerate();
        return cells
            .filter(|(_, is_in)| **is_in)
            .map(|(index, _)| index)
            .collect();
    }
    // Least squares know draws, not cells.
    let places = uncertainty
        .unvisited
        .iter()
        .filter(|place| place.indistinguishable);
    let all = inside
        .map(|point| &point.values)
        .chain(places.map(|place| &place.values));
    all.map(|values| grid.index(&grid.nearest(values)))
        .collect()
}
