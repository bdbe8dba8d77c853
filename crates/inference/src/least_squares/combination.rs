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

/// For each of these parameters, the best determined combination with another of them, if there is one. The combinations are those
/// along which two positive parameters can be exchanged: ratio and product.
pub(super) fn combinations(
    grid: &Grid,
    draws: &PosteriorDraws,
    open: &[usize],
) -> Vec<(usize, Combination)> {
    let logs = |axis: usize| -> Option<Vec<f64>> {
        let values = draws.rows().iter().map(|draw| draw[axis]);
        values
            .map(|value| (value > 0.0).then(|| libm::log(value)))
            .collect()
    };
    let all: Vec<(usize, Vec<f64>)> = open
        .iter()
        .filter_map(|axis| Some((*axis, logs(*axis)?)))
        .collect();
    let mut found = Vec::new();
    for (axis, own) in &all {
        let mut best: Option<(f64, Combination)> = None;
        for (other, others) in all.iter().filter(|(other, _)| other != axis) {
            let independent = standard_deviation(own).hypot(standard_deviation(others));
            for (sign, word) in [(-1.0, "/"), (1.0, "*")] {
                let both = own.iter().zip(others);
                let both: Vec<f64> = both.map(|(a, b)| a + sign * b).collect();
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
