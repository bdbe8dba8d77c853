//! Lets an algorithm be written as a loop and still be a function of the history.

use super::{Told, UnitPoint, fold};

/// Score of a candidate without one: worse than any that can be measured, and finite for algorithms that do arithmetic.
const FAILED: f64 = 1e30;

/// Points that an algorithm needs to know before it can go on.
pub(super) struct Unknown(pub Vec<UnitPoint>);

/// Answers an algorithm from what was told, in its order, until the history ends.
pub(super) struct Replay<'a> {
    told: &'a [Told],
    answered: usize,
}

impl<'a> Replay<'a> {
    pub fn new(told: &'a [Told]) -> Self {
        Self { told, answered: 0 }
    }

    /// The scores of points that may lie outside of the bounds.
    ///
    /// # Errors
    /// Those of them that nobody has evaluated yet, brought within the bounds.
    pub fn scores<'p>(
        &mut self,
        points: impl IntoIterator<Item = &'p [f64]>,
    ) -> Result<Vec<f64>, Unknown> {
        let (mut scores, mut unknown) = (Vec::new(), Vec::new());
        for point in points {
            match self.told.get(self.answered) {
                Some(told) => scores.push(told.score.unwrap_or(FAILED)),
                None => unknown.push(point.iter().copied().map(fold).collect()),
            }
            self.answered += usize::from(unknown.is_empty());
        }
        if unknown.is_empty() {
            Ok(scores)
        } else {
            Err(Unknown(unknown))
        }
    }

    /// The score of one point, which may lie outside of the bounds.
    ///
    /// # Errors
    /// The point, where nobody has evaluated it yet.
    pub fn score(&mut self, point: &[f64]) -> Result<f64, Unknown> {
        self.scores([point]).map(|scores| scores[0])
    }

    /// Scores given so far.
    pub fn answered(&self) -> usize {
        self.answered
    }
}
