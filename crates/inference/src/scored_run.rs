//! One evaluation of a black box, with its scores.

use realgap_core::statistics::mean;

/// One evaluation of a black box at one point, scored against every observation.
#[derive(Debug, Clone)]
pub struct ScoredRun {
    /// Coordinates of the point, 0 to 1.
    pub point: Vec<f64>,
    /// Number of the setting that the black box was evaluated with. Settings are choices that are equally valid, such as a timestep.
    pub setting: u64,
    /// Which of two variants of the black box was evaluated: 1 or -1 where there are two, 0 where there is one.
    pub variant: f64,
    /// Discrepancy from each observation that is fitted.
    pub scores: Vec<f64>,
    /// Where a single observation is fitted: discrepancies from outputs of the best point, which stand in for other observations
    /// that might have been made; one list per variant, and every output has a setting of its own. Empty where there are no such
    /// outputs.
    pub surrogate_scores: Vec<Vec<f64>>,
}

impl ScoredRun {
    /// Mean discrepancy over the observations.
    pub fn score(&self) -> f64 {
        mean(&self.scores)
    }
}
