//! The lowest score that each value of one parameter allows.

use crate::emulator::Emulator;
use crate::least_squares::LeastSquaresPosterior;
use realgap_core::quantity::Quantity;
use realgap_core::statistics::ends_of;
use realgap_optimization::Range;

/// Standard deviations to each side of the expected score that hold 90 %.
pub const BAND: f64 = 1.645;

/// Profile of the score along one parameter: the emulator's expected score, with all other parameters at their best values (profile
/// likelihood; Raue et al. 2009).
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The parameter.
    pub parameter: Quantity,
    /// Values of the parameter, increasing: those of the grid.
    pub values: Vec<f64>,
    /// Lowest expected score at each value.
    pub scores: Vec<f64>,
    /// Range that holds the lowest score with 90 %.
    pub bands: Vec<(f64, f64)>,
    /// Whether a point of the confidence set has the value.
    pub indistinguishable: Vec<bool>,
}

impl Profile {
    /// Profile of the score in a variant (0 for the mean of both) along the parameter number `axis`, whose range is given. `others` are coordinates of points from which the other
    /// parameters take their values; `inside` says whether the grid value with this number belongs to a point of the confidence set.
    pub fn new(
        (emulator, variant): (&Emulator, f64),
        (axis, range): (usize, &Range),
        others: &[Vec<f64>],
        inside: impl Fn(usize) -> bool,
    ) -> Self {
        let lowest = |value: &f64| {
            let here = others.iter().map(|point| {
                let mut point = point.clone();
                point[axis] = range.coordinate(*value);
                (emulator.mean_in(&point, variant), point)
            });
            let lowest = here.min_by(|a, b| a.0.total_cmp(&b.0));
            lowest.map_or((f64::NAN, (f64::NAN, f64::NAN)), |(score, point)| {
                (score, emulator.band(&point, variant, BAND))
            })
        };
        let values = range.values();
        let (scores, bands) = values.iter().map(lowest).unzip();
        Self {
            parameter: range.parameter,
            scores,
            bands,
            indistinguishable: (0..values.len()).map(inside).collect(),
            values,
        }
    }

    /// Profile along the parameter number `axis` of a fit by least squares, whose best point has this score. Its bands are the scores
    /// themselves: the approximation does not state how uncertain it is.
    pub fn of_least_squares(
        posterior: &LeastSquaresPosterior,
        (axis, range): (usize, &Range),
        best_score: f64,
        inside: impl Fn(f64) -> bool,
    ) -> Self {
        let values = range.values();
        let score =
            |value: &f64| best_score * posterior.relative_profile(axis, range.coordinate(*value));
        let scores: Vec<f64> = values.iter().map(score).collect();
        Self {
            parameter: range.parameter,
            bands: scores.iter().map(|score| (*score, *score)).collect(),
            indistinguishable: values.iter().map(|value| inside(*value)).collect(),
            scores,
            values,
        }
    }

    /// Largest minus smallest score along the profile: how much the parameter matters over its range.
    pub fn spread(&self) -> f64 {
        difference(self.scores.iter().copied())
    }

    /// Largest minus smallest score of the values that points of the confidence set have.
    pub fn spread_within(&self) -> f64 {
        let inside = self.scores.iter().zip(&self.indistinguishable);
        difference(inside.filter(|(_, is_in)| **is_in).map(|(score, _)| *score))
    }
}

/// Largest minus smallest number; 0 for none.
fn difference(known: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = ends_of(known);
    (high - low).max(0.0)
}
