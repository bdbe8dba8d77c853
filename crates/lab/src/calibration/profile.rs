//! The best score that each value of one parameter allows.

use realgap_core::quantity::Quantity;
use realgap_core::statistics::ends_of;
use realgap_optimization::Range;

/// Profile of the score along one parameter, all others at their best (profile likelihood, Raue et al. 2009), as the emulator
/// expects it from all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The parameter.
    pub parameter: Quantity,
    /// Values of the parameter, increasing: the study's grid.
    pub values: Vec<f64>,
    /// Lowest score to be expected at each value.
    pub scores: Vec<f64>,
    /// The range that holds it with 90 %.
    pub bands: Vec<(f64, f64)>,
    /// Whether something there cannot be told from the best.
    pub indistinguishable: Vec<bool>,
}

impl Profile {
    /// `lowest` gives score and range at a value, `inside` whether a cell has something that cannot be told from the best.
    pub(super) fn new(
        range: &Range,
        lowest: impl Fn(f64) -> (f64, (f64, f64)),
        inside: impl Fn(usize) -> bool,
    ) -> Self {
        let values = range.values();
        let (scores, bands) = values.iter().map(|value| lowest(*value)).unzip();
        Self {
            parameter: range.parameter,
            scores,
            bands,
            indistinguishable: (0..values.len()).map(inside).collect(),
            values,
        }
    }

    /// Largest minus smallest score along the profile: how much the parameter matters over its range.
    pub fn spread(&self) -> f64 {
        difference(self.scores.iter().copied())
    }

    /// Largest minus smallest score of the values that cannot be told from the best.
    pub fn spread_within(&self) -> f64 {
        let inside = self.scores.iter().zip(&self.indistinguishable);
        difference(inside.filter(|(_, is_in)| **is_in).map(|(score, _)| *score))
    }
}

/// Largest minus smallest; 0 for none.
fn difference(known: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = ends_of(known);
    (high - low).max(0.0)
}
