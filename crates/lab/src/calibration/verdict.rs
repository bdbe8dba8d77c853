//! What the recordings say about each parameter.

use std::fmt;

use serde::Serialize;

use super::{Audit, BestDraws, Estimated, INTERVAL_LEVEL, Scores, Uncertainty};
use crate::claim::{self, Claim, Conclusion, Found};
use realgap_core::statistics::ends_of;
use realgap_core::unit::quantity;
use realgap_optimization::Range;

/// One parameter's best value and the range that fits as well.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// Name of the parameter.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Best value.
    pub best: f64,
    /// Smallest value in the indistinguishable set.
    pub low: f64,
    /// Largest value in the indistinguishable set.
    pub high: f64,
    /// Central 90 % interval; `None` where there are several.
    pub interval: Option<(f64, f64)>,
    /// The parts of the 90 % interval where values between them are rejected; else empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub intervals: Vec<(f64, f64)>,
    /// False where the recordings do not determine the parameter within the searched range.
    pub identified: bool,
    /// One sentence.
    pub text: String,
    /// The same with what it rests on; it is one of the report's claims.
    #[serde(skip)]
    pub claim: Claim,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// What a study's points, and what was inferred from them, say.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    /// The parameters and where they were searched.
    pub ranges: &'a [Range],
    /// The points.
    pub scores: &'a Scores,
    /// Which of them cannot be told from the best.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Values as likely as the recordings leave them.
    pub draws: Option<&'a BestDraws>,
    /// What numerics change.
    pub audit: Option<&'a Audit>,
    /// Recordings that were fitted.
    pub recordings: usize,
}

impl Verdict {
    fn new(range: &Range, ends: (f64, f64, f64), parts: Vec<(f64, f64)>, claim: Claim) -> Self {
        let (best, low, high) = ends;
        let (interval, intervals) = match parts[..] {
            [one] => (Some(one), Vec::new()),
            _ => (None, parts),
        };
        Self {
            parameter: range.parameter.name.to_owned(),
            unit: range.parameter.unit.label().to_owned(),
            best,
            low,
            high,
            interval,
            intervals,
            identified: claim.conclusion == Conclusion::Supported,
            text: claim.text.clone(),
            claim,
        }
    }

    /// What least squares know: the ends of the 90 % interval stand for what fits as well.
    pub(super) fn of_least_squares(tables: &Tables<'_>, known: &[Estimated]) -> Vec<Self> {
        let verdict = |(known, range): (&Estimated, &Range)| {
            let ends = (known.value, known.low, known.high);
            let claim = claim::least_squares(known, tables.recordings);
            Self::new(range, ends, vec![(known.low, known.high)], claim)
        };
        known.iter().zip(tables.ranges).map(verdict).collect()
    }

    /// One verdict per parameter; none where no point has a score.
    pub fn all(tables: &Tables<'_>) -> Vec<Self> {
        let (Some(best), Some(uncertainty)) = (tables.scores.best, tables.uncertainty) else {
            return Vec::new();
        };
        let scores = tables.scores;
        let ranges = tables.ranges.iter().enumerate();
        ranges
            .map(|(dimension, range)| {
                let points = scores.points.iter().zip(&uncertainty.indistinguishable);
                let visited = points.map(|(point, is_in)| (&point.values, *is_in));
                let unvisited = uncertainty.unvisited.iter();
                let all =
                    visited.chain(unvisited.map(|place| (&place.values, place.indistinguishable)));
                let set = all.filter(|(_, is_in)| *is_in);
                let values: Vec<f64> = set.map(|(values, _)| values[dimension]).collect();
                let draws = tables.draws;
                let intervals = draws.map(|draws| draws.intervals(dimension, INTERVAL_LEVEL));
                let intervals = intervals.unwrap_or_default();
                // What the interval holds fits as well: many places that are each hardly likely are likely together.
                let ends = intervals.iter().flat_map(|(low, high)| [*low, *high]);
                let (low, high) = ends_of(values.iter().copied().chain(ends));
                let named =
                    |names: &[String]| names.iter().any(|name| name == range.parameter.name);
                let shaken = tables.audit.filter(|audit| named(&audit.shaken));
                let found = Found {
                    best: scores.points[best].values[dimension],
                    low,
                    high,
                    intervals,
                    level: INTERVAL_LEVEL,
                    is_resolved: !tables.audit.is_some_and(|audit| named(&audit.unresolved)),
                    shaken_by: shaken.and_then(Audit::worst).map(|(setting, change)| {
                        let change = quantity(change.abs(), scores.unit);
                        format!("{setting} changes the score by {change}")
                    }),
                    recordings: tables.recordings,
                };
                let claim = claim::parameter(range, &found);
                let ends = (found.best, found.low, found.high);
                Self::new(range, ends, found.intervals, claim)
            })
            .collect()
    }
}
