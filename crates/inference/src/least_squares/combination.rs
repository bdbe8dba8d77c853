//! Combinations of two parameters that recordings determine where they do not determine either: a friction over a mass.

use serde::Serialize;

use crate::posterior::{INTERVAL_LEVEL, PosteriorDraws};
use realgap_core::statistics::{median, percentile_interval, standard_deviation};
use realgap_optimization::Grid;

/// A ratio or a product of two parameters, with its 90 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Combination {
    /// The combination in words, such as `body.mass_scale / hinge.dry_nm`.
    pub name: String,
    /// Its median.
    pub value: f64,
    /// Lower end of its 90 % interval.
    pub low: f64,
    /// Upper end of its 90 % interval.
    pub high: f64,
}

/// A combination is determined where the standard deviation of its logarithm is below this share of what it would be if both parameters
/// were independent.
const TIGHT: f64 = 0.3;

/// Draws at an end of a searched range were moved there from beyond it: two parameters at their ends have a fixed ratio that no
/// recording told. A combination is judged by the other draws, where these are at least this share of all.
const LEAST_INSIDE: f64 = 0.5;

/// For each of these parameters, the best determined combination with another of them, if there is one. The combinations are those
/// along which two positive parameters can be exchanged: ratio and product.
pub(super) fn combinations(
    grid: &Grid,
    draws: &PosteriorDraws,
    open: &[usize],
) -> Vec<(usize, Combination)> {
    // The logarithm of each draw; `None` at an end of the searched range.
    let logs = |axis: usize| -> Option<Vec<Option<f64>>> {
        let range = &grid.ranges()[axis];
        let values = draws.rows().iter().map(|draw| draw[axis]);
        let is_inside = |value: f64| range.from < value && value < range.to;
        values
            .map(|value| (value >= 0.0).then(|| is_inside(value).then(|| libm::log(value))))
            .collect()
    };
    let all: Vec<(usize, Vec<Option<f64>>)> = open
        .iter()
        .filter_map(|axis| Some((*axis, logs(*axis)?)))
        .collect();
    let mut found = Vec::new();
    for (axis, own) in &all {
        let mut best: Option<(f64, Combination)> = None;
        for (other, others) in all.iter().filter(|(other, _)| other != axis) {
            let pairs: Vec<(f64, f64)> = (own.iter().zip(others))
                .filter_map(|(a, b)| Some(((*a)?, (*b)?)))
                .collect();
            if (pairs.len() as f64) < LEAST_INSIDE * own.len() as f64 {
                continue;
            }
            let (first, second): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
            let independent = standard_deviation(&first).hypot(standard_deviation(&second));
            for (sign, word) in [(-1.0, "/"), (1.0, "*")] {
                let both: Vec<f64> = pairs.iter().map(|(a, b)| a + sign * b).collect();
                let share = standard_deviation(&both) / independent.max(f64::MIN_POSITIVE);
                if share < TIGHT && best.as_ref().is_none_or(|(least, _)| share < *least) {
                    let values: Vec<f64> = both.iter().map(|log| libm::exp(*log)).collect();
                    let tail = 0.5 * (1.0 - INTERVAL_LEVEL);
                    let name = |axis: usize| grid.ranges()[axis].parameter.name;
                    let (low, high) =
                        percentile_interval(&values, tail).unwrap_or((f64::NAN, f64::NAN));
                    let combination = Combination {
                        name: format!("{} {word} {}", name(*axis), name(*other)),
                        value: median(&values),
                        low,
                        high,
                    };
                    best = Some((share, combination));
                }
            }
        }
        found.extend(best.map(|(_, combination)| (*axis, combination)));
    }
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests")]
mod tests {
    use super::*;
    use realgap_core::quantity::{Quantity, Scale};
    use realgap_core::unit::Unit;
    use realgap_optimization::Range;

    fn grid() -> Grid {
        let range = |name| {
            let parameter = Quantity {
                name,
                unit: Unit::One,
                bounds: (1.0, 100.0),
                whole: false,
                scale: Scale::Linear,
            };
            Range::new(parameter, 1.0, 100.0, 7).unwrap()
        };
        Grid::new(vec![range("a"), range("b")]).unwrap()
    }

    fn found(row: impl Fn(usize) -> [f64; 2]) -> Vec<(usize, Combination)> {
        let rows = (0..100).map(|k| row(k).to_vec()).collect();
        let draws = PosteriorDraws::new(rows, vec![Vec::new(), Vec::new()]);
        combinations(&grid(), &draws, &[0, 1])
    }

    #[test]
    fn draws_that_lie_at_the_ends_of_their_ranges_determine_no_ratio() {
        let ends = |k: usize| if k < 50 { [1.0, 1.0] } else { [100.0, 100.0] };
        assert_eq!(found(ends), []);
        // Some draws at the ends do not hide a ratio that the others have.
        let ratio = |k: usize| match k {
            0..20 => [1.0, 1.0],
            _ => [k as f64 / 2.0, k as f64],
        };
        let told = found(ratio);
        assert_eq!(told.len(), 2);
        assert_eq!(told[0].1.name, "a / b");
        assert!((told[0].1.value - 0.5).abs() < 1e-12, "{told:?}");
    }
}
