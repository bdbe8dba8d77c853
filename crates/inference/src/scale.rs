//! The scale on which scores are modelled.

use realgap_core::statistics::{mean, median, standard_deviation};

/// Scores above so many medians count as that many: how far a robot falls off a cliff tells nothing about the valley beside it, and a
/// smooth curve through both is wrong at the foot of the cliff.
const HIGHEST: f64 = 4.0;

/// Transforms scores to ln(score² + offset²) with mean 0 and standard deviation 1. A distance has a kink where the output of a black
/// box meets an observation, its square has none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScoreScale {
    offset: f64,
    mean: f64,
    sd: f64,
}

impl ScoreScale {
    /// The offset is the median score. The scale is nearly the squared score below it and logarithmic above it, so that a few very
    /// bad points do not decide how smooth the score is around the good ones.
    pub fn new(scores: &[f64]) -> Self {
        let offset = median(scores).max(f64::MIN_POSITIVE.sqrt());
        let highest = HIGHEST * offset;
        let logs = scores.iter().map(|score| score.min(highest));
        let logs: Vec<f64> = logs.map(|s| libm::log(s * s + offset * offset)).collect();
        let sd = standard_deviation(&logs);
        Self {
            offset,
            mean: mean(&logs),
            sd: if sd > 0.0 { sd } else { 1.0 },
        }
    }

    /// The standardised value of a score.
    pub(crate) fn standardise(self, score: f64) -> f64 {
        let score = score.min(self.highest());
        (libm::log(score * score + self.offset * self.offset) - self.mean) / self.sd
    }

    /// The score from which on all scores count as one.
    pub fn highest(self) -> f64 {
        HIGHEST * self.offset
    }

    /// Derivative of the standardised value with respect to the score.
    pub fn slope(self, score: f64) -> f64 {
        let score = score.min(self.highest());
        2.0 * score / ((score * score + self.offset * self.offset) * self.sd)
    }

    /// The score of a standardised value.
    pub fn score(self, value: f64) -> f64 {
        (libm::exp(value * self.sd + self.mean) - self.offset * self.offset)
            .max(0.0)
            .sqrt()
    }
}
