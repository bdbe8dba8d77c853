//! Replays the history of evaluated points to an algorithm that is written as a loop, so that it is a function of the history.

use std::cell::Cell;

use super::{EvaluatedPoint, UnitPoint, fold};

/// Score of a candidate whose evaluation failed: worse than any measured score, but finite, because some algorithms compute with
/// scores.
const FAILED: f64 = 1e30;

/// Points whose scores an algorithm needs before it can continue. It is an error type so that libraries pass it on.
#[derive(Debug)]
pub(super) struct Unknown(pub Vec<UnitPoint>);

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} points without a score", self.0.len())
    }
}

impl std::error::Error for Unknown {}

/// Answers the requests of an algorithm from the history, in the order of the history, until the history ends.
#[derive(Clone)]
pub(super) struct Replay<'a> {
    evaluated: &'a [EvaluatedPoint],
    answered: Cell<usize>,
}

impl<'a> Replay<'a> {
    pub fn new(evaluated: &'a [EvaluatedPoint]) -> Self {
        Self {
            evaluated,
            answered: Cell::new(0),
        }
    }

    /// The scores of points, which may lie outside of the bounds.
    ///
    /// # Errors
    /// The points that have not been evaluated yet, reflected into the bounds.
    pub fn scores<'p>(
        &self,
        points: impl IntoIterator<Item = &'p [f64]>,
    ) -> Result<Vec<f64>, Unknown> {
        let (mut scores, mut unknown) = (Vec::new(), Vec::new());
        for point in points {
            match self.evaluated.get(self.answered.get()) {
                Some(one) => scores.push(one.score.unwrap_or(FAILED)),
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

    /// The evaluated points for points within the bounds.
    ///
    /// # Errors
    /// The points that have not been evaluated yet.
    pub fn evaluated<'p>(
        &self,
        points: impl IntoIterator<Item = &'p [f64]>,
    ) -> Result<Vec<&'a EvaluatedPoint>, Unknown> {
        let from = self.answered.get();
        let requested: Vec<UnitPoint> = points.into_iter().map(<[f64]>::to_vec).collect();
        let known = &self.evaluated[from.min(self.evaluated.len())..];
        let known = &known[..requested.len().min(known.len())];
        self.answered.set(from + known.len());
        if known.len() < requested.len() {
            return Err(Unknown(requested[known.len()..].to_vec()));
        }
        Ok(known.iter().collect())
    }

    /// Number of points of the history that have been used so far.
    pub fn answered(&self) -> usize {
        self.answered.get()
    }
}
