//! The form `table`: values at given distances with linear interpolation.

use super::{Form, Point, least_squares};
use realgap_core::constant_methods;

/// Values at knots, linear between neighbouring knots and constant beyond the ends, for data that no formula fits.
pub struct Table;

/// Largest number of knots of a fitted table.
const MOST_KNOTS: usize = 21;

impl Table {
    /// Index of the knot below the distance, and the position between it and the next knot (0 to 1).
    fn place(knots: &[f64], d: f64) -> (usize, f64) {
        let last = knots.len() - 1;
        let above = knots.partition_point(|knot| *knot <= d);
        match above {
            0 => (0, 0.0),
            above if above > last => (last.saturating_sub(1), f64::from(u8::from(last > 0))),
            above => {
                let (low, high) = (knots[above - 1], knots[above]);
                (above - 1, (d - low) / (high - low))
            }
        }
    }
}

impl Form for Table {
    constant_methods! {
        name: &'static str = "table";
        formula: &'static str = "values at knots, linear between them";
    }

    fn knots(&self, distances: &[f64]) -> Vec<f64> {
        let count = distances.len().min(MOST_KNOTS);
        let last = distances.len() - 1;
        let mut knots: Vec<f64> = (0..count)
            .map(|k| distances[(k * last) / (count - 1).max(1)])
            .collect();
        knots.dedup();
        knots
    }

    fn parameters(&self, knots: &[f64]) -> Vec<String> {
        knots.iter().map(|knot| format!("at {knot}")).collect()
    }

    fn value(&self, knots: &[f64], parameters: &[f64], d: f64) -> f64 {
        let (below, share) = Self::place(knots, d);
        let above = (below + 1).min(parameters.len() - 1);
        parameters[below] + share * (parameters[above] - parameters[below])
    }

    fn gradient(&self, knots: &[f64], parameters: &[f64], d: f64) -> Vec<f64> {
        let (below, share) = Self::place(knots, d);
        let mut gradient = vec![0.0; parameters.len()];
        gradient[below] += 1.0 - share;
        gradient[(below + 1).min(parameters.len() - 1)] += share;
        gradient
    }

    fn is_factor(&self, _: usize) -> bool {
        true
    }

    fn start(&self, knots: &[f64], points: &[Point]) -> Option<Vec<f64>> {
        let zeros = vec![0.0; knots.len()];
        least_squares(points, |d| self.gradient(knots, &zeros, d))
    }
}
