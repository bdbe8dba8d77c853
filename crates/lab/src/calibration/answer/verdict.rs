//! The verdict on each parameter: its best value, its interval, and whether the recordings determine it.

use std::fmt;

use serde::Serialize;

use crate::calibration::{Audit, Scores, Uncertainty};
use crate::claim::{self, Claim, Conclusion, Found};
use realgap_core::unit::quantity;
use realgap_inference::{INTERVAL_LEVEL, LeastSquaresEstimate, Marginal, PosteriorDraws};
use realgap_optimization::Range;

/// The best value of one parameter, and the values that are compatible with the recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// Name of the parameter.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Best value.
    pub best: f64,
    /// Smallest value that fits as well: the lower end of the central 99 % interval of the posterior draws; for least squares of the
    /// 90 % interval.
    pub low: f64,
    /// Largest value that fits as well, in the same way.
    pub high: f64,
    /// Central 90 % interval; `None` where there are several.
    pub interval: Option<(f64, f64)>,
    /// The parts of the 90 % interval, where values between them are rejected; otherwise empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub intervals: Vec<(f64, f64)>,
    /// False where the recordings do not determine the parameter within the searched range.
    pub identified: bool,
    /// The verdict as one sentence.
    pub text: String,
    /// The same sentence with the numbers it rests on; it is one of the report's claims.
    #[serde(skip)]
    pub claim: Claim,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// The points of a study, and what was inferred from them.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    /// The parameters and their searched ranges.
    pub ranges: &'a [Range],
    /// The points.
    pub scores: &'a Scores,
    /// The confidence set.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Posterior draws of the parameters.
    pub draws: Option<&'a PosteriorDraws>,
    /// The effect of numerical settings.
    pub audit: Option<&'a Audit>,
    /// Recordings that were fitted.
    pub recordings: usize,
}

impl Verdict {
    /// The parts of the 90 % interval, increasing.
    pub fn parts(&self) -> &[(f64, f64)] {
        match self.intervals.as_slice() {
            [] => self.interval.as_slice(),
            many => many,
        }
    }

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

    /// The verdicts of least squares: the ends of the 90 % interval take the place of the confidence set.
    pub(in crate::calibration) fn of_least_squares(
        tables: &Tables<'_>,
        known: &[LeastSquaresEstimate],
    ) -> Vec<Self> {
        let verdict = |(axis, (known, range)): (usize, (&LeastSquaresEstimate, &Range))| {
            let ends = (known.value, known.low, known.high);
            let parts = tables
                .draws
                .map(|draws| draws.intervals(axis, INTERVAL_LEVEL));
            let parts = parts.unwrap_or_default();
            let claim = claim::least_squares(known, &parts, tables.recordings);
            Self::new(range, ends, parts, claim)
        };
        let all = known.iter().zip(tables.ranges);
        all.enumerate().map(verdict).collect()
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
                let values = uncertainty.values_in_set(scores, dimension);
                let marginal = Marginal::new(dimension, values, tables.draws);
                let named =
                    |names: &[String]| names.iter().any(|name| name == range.parameter.name);
                let shaken = tables.audit.filter(|audit| named(&audit.shaken));
                let found = Found {
                    best: scores.points[best].values[dimension],
                    marginal,
                    set_holds_best: uncertainty.holds_best,
                    level: INTERVAL_LEVEL,
                    is_resolved: !tables.audit.is_some_and(|audit| named(&audit.unresolved)),
                    shaken_by: shaken.and_then(Audit::worst).map(|(setting, change)| {
                        let change = quantity(change.abs(), scores.unit);
                        format!("{setting} changes the score by {change}")
                    }),
                    recordings: tables.recordings,
                };
                let claim = claim::parameter(range, &found);
                let Marginal {
                    low,
                    high,
                    intervals,
                } = found.marginal;
                Self::new(range, (found.best, low, high), intervals, claim)
            })
            .collect()
    }
}
