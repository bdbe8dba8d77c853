//! The best score that each value of one parameter allows.

use realgap_core::quantity::Quantity;
use realgap_optimize::Range;

/// Profile of the score along one parameter, all others at their best (profile likelihood, Raue et al. 2009).
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The parameter.
    pub parameter: Quantity,
    /// Values of the parameter, increasing: the study's grid; points between them count for the nearest.
    pub values: Vec<f64>,
    /// Lowest score at each value; `None` where nothing was tried or everything diverged.
    pub scores: Vec<Option<f64>>,
    /// Whether a point there cannot be told from the best.
    pub indistinguishable: Vec<bool>,
}

impl Profile {
    /// `points` are value of this parameter, score, and whether it cannot be told from the best.
    pub fn new(range: &Range, points: impl IntoIterator<Item = (f64, Option<f64>, bool)>) -> Self {
        let values = range.values();
        let mut scores: Vec<Option<f64>> = vec![None; values.len()];
        let mut indistinguishable = vec![false; values.len()];
        for (value, score, inside) in points {
            let cell = range.nearest(value);
            indistinguishable[cell] |= inside;
            scores[cell] = match (scores[cell], score) {
                (Some(known), Some(new)) => Some(known.min(new)),
                (known, new) => known.or(new),
            };
        }
        Self {
            parameter: range.parameter,
            values,
            scores,
            indistinguishable,
        }
    }

    /// Largest minus smallest score along the profile: how much the parameter matters over its range.
    pub fn spread(&self) -> f64 {
        difference(self.scores.iter().flatten())
    }

    /// Largest minus smallest score of the values that cannot be told from the best.
    pub fn spread_within(&self) -> f64 {
        let inside = self.scores.iter().zip(&self.indistinguishable);
        difference(
            inside
                .filter(|(_, is_in)| **is_in)
                .filter_map(|(score, _)| score.as_ref()),
        )
    }
}

/// Largest minus smallest; 0 for none.
fn difference<'a>(known: impl Iterator<Item = &'a f64>) -> f64 {
    let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| {
        (low.min(*s), high.max(*s))
    });
    (high - low).max(0.0)
}
