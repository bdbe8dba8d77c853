//! What is known about two parameters together, from the posterior draws.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::calibration::PosteriorDraws;
use realgap_core::statistics::{median, percentile_interval};
use realgap_optimization::Grid;
use realgap_simulation::parameter;

/// Correlation of two parameters over the posterior draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Correlation {
    /// Name of one parameter.
    pub first: &'static str,
    /// Name of the other parameter.
    pub second: &'static str,
    /// Pearson's coefficient.
    pub value: f64,
}

impl Correlation {
    /// Of all pairs.
    pub(super) fn all(grid: &Grid, draws: Option<&PosteriorDraws>) -> Vec<Self> {
        let Some(draws) = draws else {
            return Vec::new();
        };
        let ranges = grid.ranges();
        let pairs = (0..ranges.len()).flat_map(|a| (a + 1..ranges.len()).map(move |b| (a, b)));
        pairs
            .map(|(a, b)| Self {
                first: ranges[a].parameter.name,
                second: ranges[b].parameter.name,
                value: draws.correlation(a, b),
            })
            .collect()
    }
}

/// Level of the interval of a difference: where both sets of recordings have one value, it leaves 0 out in 5 % of all studies.
pub(crate) const DIFFERENCE_LEVEL: f64 = 0.95;
/// Sets of recordings up to which every pair is compared. With a value for each recording the pairs would be too many to read, and some
/// would differ by chance.
const MOST_SETS: usize = 3;

/// By how much a parameter differs between two sets of recordings, `run.A.floor.friction` minus `run.B.floor.friction`, over the
/// posterior draws. Both are drawn together, so that what they share (a mass, a motor) cancels.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// The parameter of one set.
    pub first: &'static str,
    /// The parameter of the other set.
    pub second: &'static str,
    /// The median of the first minus the second, in the parameter's unit.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

impl Difference {
    /// Of all pairs of the same parameter, of at most three sets of recordings each.
    pub(super) fn all(grid: &Grid, draws: Option<&PosteriorDraws>) -> Vec<Self> {
        let Some(draws) = draws else {
            return Vec::new();
        };
        let ranges = grid.ranges();
        // The parameters of one set of recordings each, with the number of their range, by what they are of all recordings.
        let mut alike: BTreeMap<&'static str, Vec<usize>> = BTreeMap::new();
        for (axis, range) in ranges.iter().enumerate() {
            let known = parameter::by_name(range.parameter.name).ok();
            if let Some(own) = known.filter(|own| own.run().is_some()) {
                alike.entry(own.of_all().name).or_default().push(axis);
            }
        }
        let tail = 0.5 * (1.0 - DIFFERENCE_LEVEL);
        let mut all = Vec::new();
        for sets in alike.into_values().filter(|sets| sets.len() <= MOST_SETS) {
            let pairs = (sets.iter().enumerate())
                .flat_map(|(k, first)| sets[k + 1..].iter().map(move |second| (*first, *second)));
            for (first, second) in pairs {
                let rows = draws.rows().iter();
                let apart: Vec<f64> = rows.map(|row| row[first] - row[second]).collect();
                if let Some((low, high)) = percentile_interval(&apart, tail) {
                    all.push(Self {
                        first: ranges[first].parameter.name,
                        second: ranges[second].parameter.name,
                        value: median(&apart),
                        low,
                        high,
                    });
                }
            }
        }
        all
    }

    /// Whether the interval leaves 0 out.
    pub fn is_told(&self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests")]
mod tests {
    use super::*;
    use realgap_optimization::Range;

    fn grid(names: &[&str]) -> Grid {
        let range = |name: &&str| {
            let known = parameter::by_name(name).unwrap();
            Range::new(known, 0.1, 1.6, 7).unwrap()
        };
        Grid::new(names.iter().map(range).collect()).unwrap()
    }

    #[test]
    fn what_two_floors_share_cancels_in_their_difference() {
        let names = [
            "run.a_*.floor.friction",
            "run.b_*.floor.friction",
            "floor.friction",
        ];
        // Both frictions move together by far more than they differ.
        let row = |k: usize| {
            let shared = 0.4 + 0.01 * (k % 40) as f64;
            vec![shared + 0.1 + 0.001 * (k % 7) as f64, shared, 0.5]
        };
        let draws = PosteriorDraws::new((0..280).map(row).collect(), vec![Vec::new(); 3]);
        let found = Difference::all(&grid(&names), Some(&draws));
        assert_eq!(found.len(), 1);
        assert!(found[0].is_told(), "{found:?}");
        assert!((found[0].value - 0.103).abs() < 1e-9, "{found:?}");
        assert!(found[0].low > 0.0999 && found[0].high < 0.1071, "{found:?}");
        assert_eq!((found[0].first, found[0].second), (names[0], names[1]));
    }

    #[test]
    fn a_value_for_each_of_many_recordings_is_not_compared_pair_by_pair() {
        let names = [
            "run.a.floor.friction",
            "run.b.floor.friction",
            "run.c.floor.friction",
            "run.d.floor.friction",
        ];
        let draws = PosteriorDraws::new(vec![vec![0.2, 0.4, 0.6, 0.8]; 50], vec![Vec::new(); 4]);
        assert_eq!(Difference::all(&grid(&names), Some(&draws)), []);
        let three = Difference::all(&grid(&names[..3]), Some(&draws));
        assert_eq!(three.len(), 3);
    }
}
