//! What points and draws tell about one parameter, and whether they determine it.

use crate::posterior::{INTERVAL_LEVEL, POSSIBLE_LEVEL, PosteriorDraws};
use realgap_core::statistics::ends_of;
use realgap_optimization::Range;

/// A range of values that comes this near to an end of the searched range, as a share of the latter, reaches the end.
const AT_THE_END: f64 = 0.05;
/// Intervals that together are as long as this share of the searched range, or longer, determine nothing.
const WIDE: f64 = 0.5;

/// The values of one parameter that are compatible with the observations.
#[derive(Debug, Clone, PartialEq)]
pub struct Marginal {
    /// Smallest value that fits as well: the lower end of the central interval at [`POSSIBLE_LEVEL`]; without draws the smallest in
    /// the confidence set.
    pub low: f64,
    /// Largest value that fits as well, in the same way.
    pub high: f64,
    /// Central intervals at [`INTERVAL_LEVEL`], one for each part of the range between rejected parts; empty where there are no draws.
    pub intervals: Vec<(f64, f64)>,
}

/// How far the observations determine a parameter within the searched range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Determination {
    /// Compatible values reach both ends of the searched range: the parameter is not determined.
    Open,
    /// The intervals cover half of the searched range or more: the parameter is not determined.
    Wide,
    /// Compatible values reach an end of the searched range where the parameter itself could go farther.
    EdgeOfSearch,
    /// Compatible values reach only the lower bound of the parameter: there is an upper limit.
    AtMost,
    /// Compatible values reach only the upper bound of the parameter: there is a lower limit.
    AtLeast,
    /// Compatible values lie inside of the searched range.
    Inside,
}

impl Marginal {
    /// Of parameter number `axis`, from its values in the confidence set and from the posterior draws.
    pub fn new(
        axis: usize,
        confidence_set: impl Iterator<Item = f64>,
        draws: Option<&PosteriorDraws>,
    ) -> Self {
        let intervals = draws.map(|draws| draws.intervals(axis, INTERVAL_LEVEL));
        let intervals = intervals.unwrap_or_default();
        // The confidence set is one of all parameters together: along one of them it is wider, and a single point decides its ends.
        let (low, high) = match draws {
            Some(draws) => {
                let (low, high) = draws.interval(axis, POSSIBLE_LEVEL);
                // The interval of a part of the range may reach beyond that of all draws.
                let ends = intervals.iter().flat_map(|(low, high)| [*low, *high]);
                ends_of(ends.chain([low, high]))
            }
            None => ends_of(confidence_set),
        };
        Self {
            low,
            high,
            intervals,
        }
    }

    /// Whether an interval reaches an end of the searched range; without intervals, whether the compatible values do.
    pub fn reaches_end(&self, range: &Range) -> bool {
        let ends = self.parts().into_iter().flat_map(|(low, high)| [low, high]);
        let mut ends = ends.map(|value| range.coordinate(value));
        ends.any(|end| !(AT_THE_END..1.0 - AT_THE_END).contains(&end))
    }

    /// The intervals; without draws, all compatible values.
    fn parts(&self) -> Vec<(f64, f64)> {
        match self.intervals.is_empty() {
            true => vec![(self.low, self.high)],
            false => self.intervals.clone(),
        }
    }

    /// How far the compatible values are determined within the searched range.
    pub fn determination(&self, range: &Range) -> Determination {
        let low_end = range.coordinate(self.low) <= AT_THE_END;
        let high_end = range.coordinate(self.high) >= 1.0 - AT_THE_END;
        // At a bound of the parameter itself (a restitution of 0) the search cannot be widened.
        let (lowest, highest) = range.parameter.bounds;
        let can_widen = (low_end && range.from > lowest) || (high_end && range.to < highest);
        let covered = self.parts().into_iter();
        let covered = covered.map(|(low, high)| range.coordinate(high) - range.coordinate(low));
        let covered: f64 = covered.sum();
        match (low_end, high_end) {
            (true, true) => Determination::Open,
            _ if covered >= WIDE => Determination::Wide,
            _ if can_widen => Determination::EdgeOfSearch,
            (true, false) => Determination::AtMost,
            (false, true) => Determination::AtLeast,
            (false, false) => Determination::Inside,
        }
    }
}
