//! Turns a library that owns its loop into one that can be asked.

use std::cell::{Cell, RefCell};

use super::{Told, UnitPoint, fold};

/// Score of a candidate without one: worse than any that can be measured, and finite for libraries that do arithmetic.
const FAILED: f64 = 1e30;

/// Answers a solver's calls from what was told, in order; beyond that it notes the point down and gives a filler, after
/// which the solver must not be believed any more.
pub(super) struct Replay<'a> {
    told: &'a [Told],
    calls: Cell<usize>,
    asked: RefCell<Vec<UnitPoint>>,
}

impl<'a> Replay<'a> {
    pub fn new(told: &'a [Told]) -> Self {
        Self {
            told,
            calls: Cell::new(0),
            asked: RefCell::new(Vec::new()),
        }
    }

    /// The score at a point that may lie outside the bounds.
    pub fn cost(&self, point: impl IntoIterator<Item = f64>) -> f64 {
        let call = self.calls.get();
        self.calls.set(call + 1);
        match self.told.get(call) {
            Some(told) => told.score.unwrap_or(FAILED),
            None => {
                let point: UnitPoint = point.into_iter().map(fold).collect();
                self.asked.borrow_mut().push(point);
                FAILED
            }
        }
    }

    /// Calls answered so far.
    pub fn calls(&self) -> usize {
        self.calls.get()
    }

    /// The points that nobody has evaluated yet, in the order of the calls; empty while the history lasts.
    pub fn asked(&self) -> Vec<UnitPoint> {
        self.asked.borrow().clone()
    }
}
