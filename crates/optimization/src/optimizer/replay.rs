//! Lets an algorithm be written as a loop and still be a function of the history.

use std::cell::Cell;

use super::{EvaluatedPoint, UnitPoint, fold};

/// Score of a candidate without one: worse than any that can be measured, and finite for algorithms that do arithmetic.
const FAILED: f64 = 1e30;

/// Points that an algorithm needs to know before it can go on; an error, so that a library hands it on.
#[derive(Debug)]
pub(super) struct Unknown(pub Vec<UnitPoint>);

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} points without a score", self.0.len())
    }
}

impl std::error::Error for Unknown {}

/// Answers an algorithm from what was told, in its order, until the history ends.
#[derive(Clone)]
pub(super) struct Replay<'a> {
    told: &'a [EvaluatedPoint],
    answered: Cell<usize>,
}

impl<'a> Replay<'a> {
    pub fn new(told: &'a [EvaluatedPoint]) -> Self {
        Self {
            told,
            answered: Cell::new(0),
        }
    }

    /// The scores of points that may lie outside of the bounds.
    ///
    /// # Errors
    /// Those of them that nobody has evaluated yet, brought within the bounds.
    pub fn scores<'p>(
        &self,
        points: impl IntoIterator<Item = &'p [f64]>,
    ) -> Result<Vec<f64>, Unknown> {
        let (mut scores, mut unknown) = (Vec::new(), Vec::new());
        for point in points {
            match self.told.get(self.answered.get()) {
                Some(told) => scores.push(told.score.unwrap_or(FAILED)),
                None => unknown.push(point.iter().copied().map(fold).collect()),
            }
            self.answered
                .set(self.answered.get() + usize::from(unknown.is_empty()));
        }
        if unknown.is_empty() {
            Ok(scores)
        } else {
            Err(Unknown(unknown))
        }
    }

    /// What was told of points within the bounds.
    ///
    /// # Errors
    /// Those of them that nobody has evaluated yet.
    pub fn told<'p>(
        &self,
        points: impl IntoIterator<Item = &'p [f64]>,
    ) -> Result<Vec<&'a EvaluatedPoint>, Unknown> {
        let from = self.answered.get();
        let asked: Vec<UnitPoint> = points.into_iter().map(<[f64]>::to_vec).collect();
        let known = &self.told[from.min(self.told.len())..];
        let known = &known[..asked.len().min(known.len())];
        self.answered.set(from + known.len());
        if known.len() < asked.len() {
            return Err(Unknown(asked[known.len()..].to_vec()));
        }
        Ok(known.iter().collect())
    }

    /// Scores given so far.
    pub fn answered(&self) -> usize {
        self.answered.get()
    }
}
